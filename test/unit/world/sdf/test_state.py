"""Saved states move models and links."""

from sdf_files import BOX, SPHERE, collision, model, world_file

from aro_robocop_goto_as.world.load import load_world


def test_saved_state_moves_models_and_links_as_in_gazebo(tmp_path):
    still = "<model name='{}'><static>1</static>" + BOX + "</model>"
    state = """<state world_name="w"><sim_time>1 2</sim_time><iterations>3</iterations>
      <insertions/><deletions></deletions>
      <model name="a"><static>1</static><pose frame="">1 2 3 0 0 0</pose><scale>1 1 1</scale><joint name="j"/></model>
      <model name="b"><pose>9 9 9 0 0 0</pose><link name="l"><pose>4 5 6 0 0 0</pose><wrench>0 0 0 0 0 0</wrench></link>
      </model><model name="gone"><pose>0 0 0 0 0 0</pose></model><light name="sun"/></state>"""
    world = load_world(world_file(tmp_path, still.format("a") + still.format("b") + state))
    assert [o.pose.position for o in world.obstacles] == [(1, 2, 3), (4, 5, 6)]
    assert world.ignored == world.approximated == ()


def test_scales_in_a_state_are_left_out_with_a_note(tmp_path):
    link = '<link name="l"><pose>7 0 0 0 0 0</pose><scale>1 1 1</scale></link>'
    state = f'<state><model name="m"><pose>5 0 0 0 0 0</pose>\n<scale>1 2  1</scale>{link}</model></state>'
    world = load_world(world_file(tmp_path, model(collision(SPHERE)) + state))
    assert world.obstacles[0].pose.position == (7, 0, 0) and world.obstacles[0].geometry.radius == 0.5
    assert world.approximated == ("<scale> 1 2  1 in the state of 'm' is left out (line 6)",)
