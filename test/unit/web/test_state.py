"""The state that the parts of the page share."""

from aro_robocop_goto_as.web.state import PageState, SharedState


def test_the_selected_robot_is_the_one_chosen_as_long_as_there_is_one_of_that_name():
    state = SharedState(PageState())
    assert state.now.selected == ""
    state.change(robots=("blue", "red"))
    assert state.now.selected == "blue"
    state.change(chosen="red")
    assert state.now.selected == "red"
    state.change(robots=("blue",))
    assert state.now.selected == "blue"
