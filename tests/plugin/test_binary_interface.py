"""The plug-in fits the running YADE, and detects every wrong claim about it."""
import glob
import re
import subprocess

import pytest


@pytest.fixture(scope="module")
def plugin():
    import yade
    assert yade.O is not None  # YADE must be up first
    import cd_engine
    return cd_engine._plugin()


def test_layout_is_confirmed_and_agrees_with_the_documented_offsets(plugin):
    """Offsets of amd64's 2023.02a-1, read independently from the package's machine code and Python registration."""
    layout = dict(plugin.layout())
    known = {"Scene.forces": 32, "Scene.dt": 440, "Scene.iter": 448, "Scene.bodies": 600, "Scene.interactions": 616, "State.vel": 144,
             "State.mass": 168,
             "State.angVel": 176, "State.blockedDOFs": 304, "Interaction.geom": 112, "Interaction.phys": 128, "Engine.scene": 24, "Engine.label": 72,
             "ScGeom.penetrationDepth": 160, "NormPhys.kn": 32, "NormPhys.normalForce": 40, "NormShearPhys.ks": 64,
             "NormShearPhys.shearForce": 72}
    assert {name: layout[name] for name in known} == known


def test_a_true_claim_passes(plugin):
    plugin.layout(dict(layout_claims(plugin)))


def layout_claims(plugin):
    return [(name, offset) for name, offset in plugin.layout() if "vtable" not in name]


def test_every_wrong_offset_is_found_out(plugin):
    """For all members, one after the other, an offset 8 bytes too large or too small is claimed."""
    for name, offset in layout_claims(plugin):
        for lie in (offset + 8, offset - 8):
            if lie < 0:
                continue
            with pytest.raises(ImportError, match=re.escape(name)) as caught:
                plugin.layout({name: lie})
            assert "expected" in str(caught.value) and "found" in str(caught.value), name


def test_every_wrong_type_is_found_out(plugin):
    confirmed_by_round_trip = {"State.pos", "State.ori", "State.blockedDOFs", "Scene.engines", "Scene.bodies", "Scene.interactions", "Scene.forces",
                               "InteractionContainer.linear",
                               "GlobalEngine.sizeof", "Engine.scene", "Engine.timingInfo"}
    for name, _ in layout_claims(plugin):
        if name in confirmed_by_round_trip or name.endswith(".Factorable"):  # the place of a base class has no type of its own
            continue
        with pytest.raises(ImportError, match=re.escape(name)):
            plugin.layout({name: "float"})


def test_every_wrong_virtual_function_is_found_out(plugin):
    for name, _ in plugin.layout():
        if "vtable" in name:
            with pytest.raises(ImportError, match=re.escape(name)):
                plugin.layout({name: "_ZN4yade6Engine14explicitActionEv"})


@pytest.mark.parametrize("wild", [1 << 40, 4096, 100000, 3])
@pytest.mark.parametrize("member", ["Scene.forces", "Scene.engines", "Scene.bodies", "Scene.interactions", "InteractionContainer.linear",
                                    "State.blockedDOFs", "Engine.scene", "State.pos"])
def test_a_wild_offset_is_refused_and_does_not_crash(plugin, member, wild):
    with pytest.raises(ImportError, match=re.escape(member)):
        plugin.layout({member: wild})


def test_a_lie_about_an_unknown_member_is_refused(plugin):
    with pytest.raises(ImportError, match="State.nothing"):
        plugin.layout({"State.nothing": 8})


def test_lies_leave_the_confirmed_layout_alone(plugin):
    before = plugin.layout()
    with pytest.raises(ImportError):
        plugin.layout({"State.vel": 8})
    assert plugin.layout() == before


def test_vtable_order_agrees_with_the_relocations_of_the_library():
    """The order abi.hpp declares, read from the file: relocations against the vtable of GlobalEngine (binutils)."""
    library, = glob.glob("/usr/lib/*/yade-double/libyade.so")
    symbols = subprocess.run(["nm", "-D", library], capture_output=True, text=True, check=True).stdout
    start = int(re.search(r"^([0-9a-f]+) \S _ZTVN4yade12GlobalEngineE$", symbols, re.M).group(1), 16)
    slots = {}
    for line in subprocess.run(["readelf", "-Wr", library], capture_output=True, text=True, check=True).stdout.splitlines():
        parts = line.split()
        if len(parts) >= 5 and re.fullmatch("[0-9a-f]{12,16}", parts[0]) and parts[2] == "R_X86_64_64":
            slots[int(parts[0], 16)] = parts[4]
    order = [slots.get(start + 16 + 8 * i, "") for i in range(14)]
    names = ["12GlobalEngineD1Ev", "12GlobalEngineD0Ev", "16getBaseClassName", "18getBaseClassNumber", "12getClassName", "9pySetAttr", "6pyDict",
             "12pyDictCustom",
             "12callPostLoad", "27checkPyClassRegistersItself", "15pyRegisterClass", "22pyHandleCustomCtorArgs", "11isActivated", "6action"]
    assert all(name in slot for name, slot in zip(names, order)), order
