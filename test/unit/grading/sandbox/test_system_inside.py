"""What of the system a program in the sandbox finds."""

from robocop_grading.sandbox.bubblewrap import NAME


def test_current_user_has_a_name_a_home_and_fonts(printed):
    code = """
    import getpass, grp, os, pwd
    import matplotlib.pyplot as plt
    user, group = pwd.getpwuid(os.getuid()), grp.getgrgid(os.getgid()).gr_name
    plt.title("fonts")
    plt.savefig("figure.png")
    print(getpass.getuser(), user.pw_name, user.pw_dir, group, os.path.expanduser("~"), os.listdir("/etc/fonts") != [])
    """
    lines = [line for line in printed(code) if "font cache" not in line]  # told after 5 s
    assert lines == [f"{NAME} {NAME} /tmp/home {NAME} /tmp/home True"]


def test_files_of_etc_that_not_everybody_may_read_are_hidden(printed):
    code = """
    import os
    for folder, folders, files in os.walk("/etc"):
        for path in (os.path.join(folder, name) for name in folders + files):
            mode = 0 if os.path.islink(path) else os.stat(path).st_mode
            if mode and not mode & 0o004 or "/shadow" in path or path == "/etc/ssl/private":
                try:
                    print("SUCCESS", path, os.listdir(path) if os.path.isdir(path) else open(path).read())
                except OSError:
                    print("refused", path)
    """
    lines = printed(code)
    assert "refused /etc/shadow" in lines
    assert not [line for line in lines if not line.startswith("refused ")]


def test_the_kernel_ends_what_is_inside_first_if_memory_runs_out(printed):
    code = """
    file = "/proc/self/oom_score_adj"
    print(open(file).read().strip())
    try:
        open(file, "w").write("0")
    except OSError:
        print("refused")
    """
    assert printed(code) == ["1000", "refused"]
