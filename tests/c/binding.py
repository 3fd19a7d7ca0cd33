"""The C face from another language, by what its header says alone: binding.py HEADER LIBRARY SCENE

Reads every constant, struct and function of thimble_c.h as a binding for Rust or MicroPython would, opens a baked scene,
draws it at 128 x 64 in 16 greys and prints the CRC-32 of the bytes; then what is under the pixel in the middle.
"""

import ctypes
import re
import sys
import zlib

header, library, scene = sys.argv[1:]
text = re.sub(r"/\*.*?\*/|//[^\n]*", "", open(header).read(), flags=re.S)
C = {"void": None, "char": ctypes.c_char, "size_t": ctypes.c_size_t}
C.update({f"{u}int{n}_t": getattr(ctypes, f"c_{u}int{n}") for u in ("", "u") for n in (8, 16, 32, 64)})
C_TYPES = len(C)
number = {}
for body in re.findall(r"\benum \w+ \{([^}]*)\}", text):
    for name, value in re.findall(r"(\w+) = ([^,}]+)", body):
        wide = re.fullmatch(r"sizeof\(void\*\) > 4 \? (\d+) : (\d+)\s*", value)
        number[name] = int(wide[1 if ctypes.sizeof(ctypes.c_void_p) > 4 else 2] if wide else value, 0)


def kind(said):
    """A type of C; a pointer is one to what it says, so that nothing else can be handed over."""
    name = said.replace("const", "").replace("*", "").strip()
    if "*" not in said:
        return C[name]
    return {"void": ctypes.c_void_p, "char": ctypes.c_char_p}.get(name) or ctypes.POINTER(C[name])


for body, name in re.findall(r"\bstruct [^;{}]*\{([^}]*)\} (\w+);", text):
    fields = []
    for said, field, count in re.findall(r"([\w ]+?[ *]+)(\w+)(?:\[(\w+)\])?;", body):
        many = number[count] if count in number else int(count or 0)
        fields.append((field, kind(said) * many if many else kind(said)))
    C[name] = type(name, (ctypes.Structure,), {"_fields_": fields})
thimble = ctypes.CDLL(library)
names = re.findall(r"^([\w ]+?[ *]+)(thimble_\w+)\(([^)]*)\);", text, re.M)
for result, name, takes in names:
    function = getattr(thimble, name)
    function.restype = kind(result)
    function.argtypes = [kind(re.sub(r"\w+\s*$", "", one)) for one in takes.split(",") if one != "void"]
if len(names) != len(re.findall(r"\bthimble_\w+\(", text)) or text.count("typedef struct") != len(C) - C_TYPES:
    sys.exit("the header has a struct or a function that this does not read")


def call(name, *arguments):
    status = getattr(thimble, f"thimble_{name}")(*arguments)
    if status != number["THIMBLE_OK"]:
        sys.exit(f"thimble_{name}: {thimble.thimble_status_text(status).decode()}")


data = open(scene, "rb").read()
if thimble.thimble_scene_open(None, data, len(data)) != number["THIMBLE_BAD_ARGUMENT"]:
    sys.exit("no scene to write to is taken")
opened, camera, shading, hit = (C[f"thimble_{one}_t"]() for one in ("scene", "camera", "shading", "hit"))
pixels = (ctypes.c_uint8 * (128 * 64 // 2))()
band = C["thimble_band_t"](pixels=pixels, size_bytes=len(pixels), format=number["THIMBLE_FORMAT_GRAY4"], rows=64)
call("scene_open", opened, data, len(data))
call("scene_camera", opened, None, 128, 64, camera)
call("scene_shading", opened, shading)
call("scene_render", opened, camera, shading, band)
call("scene_pick", opened, camera, 64, 32, hit)
print(f"{zlib.crc32(pixels):08x}")
print(hit.kind, hit.voxel.x, hit.voxel.y, hit.voxel.z, hit.t_q32)
print(f"{len(number)} constants, {len(C) - C_TYPES} structs, {len(names)} functions", file=sys.stderr)
