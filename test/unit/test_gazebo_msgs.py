"""Gazebo's message types for packages of others, in compat/."""

from pathlib import Path

from support import ROOT


def _md5sums():
    """Type definition file -> md5sum, as computed by ROS's tools."""
    from genmsg import MsgContext, gentools, msg_loader

    share = Path(ROOT, "compat", "gazebo_msgs")
    search = {
        "gazebo_msgs": [str(share / "msg")],
        **{name: [f"/usr/share/{name}/msg"] for name in ("geometry_msgs", "std_msgs")},
    }
    md5sums = {}
    for path in sorted(share.glob("*/*.[ms][sr][gv]")):
        context = MsgContext.create_default()
        load = msg_loader.load_msg_from_file if path.suffix == ".msg" else msg_loader.load_srv_from_file
        spec = load(context, str(path), f"gazebo_msgs/{path.stem}")
        msg_loader.load_depends(context, spec, search)
        md5sums[path.name] = gentools.compute_md5(context, spec)
    return md5sums


def test_gazebo_types_have_the_md5sums_of_the_originals():
    assert _md5sums() == {
        "ContactState.msg": "48c0ffb054b8c444f870cecea1ee50d9",
        "ContactsState.msg": "acbcb1601a8e525bf72509f18e6f668d",
        "LinkState.msg": "0818ebbf28ce3a08d48ab1eaa7309ebe",
        "LinkStates.msg": "48c080191eb15c41858319b4d8a609c2",
        "ModelState.msg": "9330fd35f2fcd82d457e54bd54e10593",
        "ModelStates.msg": "48c080191eb15c41858319b4d8a609c2",
        "ODEJointProperties.msg": "1b744c32a920af979f53afe2f9c3511f",
        "ODEPhysics.msg": "667d56ddbd547918c32d1934503dc335",
        "ApplyBodyWrench.srv": "585b9f9618aa0581b207e2f2d90866bc",
        "ApplyJointEffort.srv": "c0039811b8cc919490b3cff748cdf46b",
        "BodyRequest.srv": "5eade9afe7f232d78005bd0cafeab755",
        "DeleteLight.srv": "ae11ea8100d536d5b92c2b5917abf912",
        "DeleteModel.srv": "9ce56b4e9e54616de25d796dc972a262",
        "GetJointProperties.srv": "7b30be900f50aa21efec4a0ec92d91c9",
        "GetLinkProperties.srv": "0e06a70386d0ee3fb880c02f23fcd821",
        "GetLinkState.srv": "09d6c98cce97b35f7ab9bd70300657ab",
        "GetModelProperties.srv": "5717f7bd34ed990fa80e28b3015027a3",
        "GetModelState.srv": "4c515e936d3319c9610c559c60bfc3d4",
        "GetPhysicsProperties.srv": "575a5e74786981b7df2e3afc567693a6",
        "GetWorldProperties.srv": "36bb0f2eccf4d8be971410c22818ba3f",
        "JointRequest.srv": "0be1351618e1dc030eb7959d9a4902de",
        "SetJointProperties.srv": "15a76e921b1410c698d82782ea5fa370",
        "SetLinkProperties.srv": "d534ce1b36ee99de0ffa806c3a6348f0",
        "SetLinkState.srv": "8a5146eb66ae4d26b0860b08f3f271be",
        "SetModelConfiguration.srv": "10e3139d3b669c40afc057d38956fff7",
        "SetModelState.srv": "5b3ab0281d4f5445def017e3a2e4a07b",
        "SetPhysicsProperties.srv": "97e2057080558ce4730434b5fae75c91",
        "SpawnModel.srv": "9ed9c82c96abe1a00c3e8cdaeee24413",
    }
