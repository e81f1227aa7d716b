"""Effects on a picture: each is a field of `Effects`, and a file of GLSL beside it.

The options of `play`, keys, panel and help of the window, uniforms, and the controls of web pages
follow from the fields.
"""

from dataclasses import dataclass, field, fields
from typing import Any


@dataclass(frozen=True)
class Effect:
    """An effect, and how its strength is chosen.

    For the effect "fog", fog.glsl has a function ``vec3 with_fog(vec3 light, float strength)``. It
    is called for each sample of a picture, unless the strength is 0.
    """

    name: str  #: also of the option of `play`, and of the field of a `Style`
    default: Any  #: strength as a float, or whether the effect is on
    text: str  #: describes the effect in the window
    help: str  #: describes the option, and the control of pages
    key: str = ""  #: selects the next strength in the window
    steps: tuple[float, ...] = (0.0, 1.0)  #: strengths for the key, from the slider's first to last
    limit: float = 1  #: largest strength that the option accepts
    shader: str = "shade.frag"  #: for effects on the plant; "ground.frag" for the background

    @property
    def is_switch(self) -> bool:
        """Whether the effect is on or off, without strengths in between."""
        return isinstance(self.default, bool)

    @property
    def label(self) -> str:
        """The name for users."""
        return self.name.replace("_", " ").capitalize()

    @property
    def uniform(self) -> str:
        """The name of the uniform that holds the strength."""
        return f"{self.name}_strength"


def effect(default: Any, **properties: Any) -> Any:
    """Declare a field of `Effects`; the properties are those of an `Effect`."""
    return field(default=default, metadata=properties)


@dataclass(frozen=True, kw_only=True)
class Effects:
    """The strengths of all effects, which are applied in this order."""

    shading: float = effect(
        1.0,
        text="shading: none, soft, strong",
        help="Strength of the shading; 0: none.",
        key="m",
        steps=(0.0, 1.0, 2.0),
        limit=5,
    )
    floor: bool = effect(
        True,
        text="floor and shadow",
        help="Draw a floor, with a shadow.",
        key="b",
        shader="ground.frag",
    )
    depth_cue: bool = effect(True, text="depth cue", help="Let far parts fade.", key="d")

    @property
    def uniforms(self) -> dict[str, Any]:
        """The strengths by the names of their uniforms."""
        return {one.uniform: float(getattr(self, one.name)) for one in EFFECTS}


EFFECTS = tuple(Effect(one.name, one.default, **one.metadata) for one in fields(Effects))


def effects_of(shader: str) -> str:
    """The effects of a shader as one function in GLSL, ``vec3 with_effects(vec3 light)``."""
    found = [one for one in EFFECTS if one.shader == shader]
    files = [f'uniform float {one.uniform};\n#include "effects/{one.name}.glsl"\n' for one in found]
    call = "    if ({0.uniform} > 0.0) light = with_{0.name}(light, {0.uniform});\n"
    calls = map(call.format, found)
    return "".join([*files, "vec3 with_effects(vec3 light) {\n", *calls, "    return light;\n}\n"])
