"""Name and type of the go-to action, shared by its server and its clients."""

ACTION = "robocop_goto_as"  # fixed by the handout
ACTION_TYPE = "aro_robocop_goto_as/GoToPositionAction"
