"""The files below run inside rostest, which has a master for them; pytest runs them only through test_rostests.py."""

collect_ignore_glob = ["*_test.py"]
