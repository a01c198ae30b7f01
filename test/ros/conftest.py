"""What is in nodes/ runs inside rostest, which has a master for it; pytest runs it only through test_rostests.py."""

collect_ignore = ["nodes"]
