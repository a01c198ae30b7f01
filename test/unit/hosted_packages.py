"""Folders with packages to host."""

LAB = "aro_robocop_goto_as"
MANIFEST = "<package><name> {} </name></package>"


def tree(top, files):
    """Write files, given by their paths and texts, below a folder; returns it."""
    for name, text in files.items():
        (top / name).parent.mkdir(parents=True, exist_ok=True)
        (top / name).write_text(text)
    return top
