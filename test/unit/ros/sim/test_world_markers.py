"""What RViz shows of the world: robots can be told apart."""

from aro_robocop_goto_as.ros.sim.world_markers import body_color, robot_markers


def test_robots_have_names_in_their_frames_and_different_colours_and_those_named_after_a_colour_have_that_one():
    robots = [(f"robot_{number}", f"robot_{number}/base_footprint", 0.1) for number in range(1, 7)]
    markers = robot_markers(robots)
    assert [(m.text, m.header.frame_id) for m in markers if m.ns == "names"] == [robot[:2] for robot in robots]
    bodies = [marker.color for marker in markers if marker.ns == "robots"]
    assert len({(color.r, color.g, color.b) for color in bodies}) == 6
    red, blue = (body_color(name, 1) for name in ("red", "blue"))
    assert red.r > 2 * red.b and blue.b > 2 * blue.r
