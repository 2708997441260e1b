"""The shaders, in GLSL 3.3; all write colours with premultiplied alpha.

Each shape is one quad per instance, scaled in the vertex shader to the bounds of the shape.
Coordinates are pixels of the canvas, y down.
"""

from jostle_lab.draw.palette import DISCS
from jostle_lab.draw.software import POINT_RADIUS, RIM_FROM, RIM_SHADE, RIM_WIDTH

_HEAD = """#version 330
uniform vec2 size;
vec4 on_screen(vec2 at) { return vec4(2.0 * at.x / size.x - 1.0, 1.0 - 2.0 * at.y / size.y, 0, 1); }
"""

# A disc has a smooth edge and a darker rim, as in `software`. The smallest are distributed over
# pixels by their area.
DISC = (
    f"""{_HEAD}
in vec2 corner;
in vec3 disc;
in uint shade;
uniform vec3 ramp[{len(DISCS)}];
uniform float least;
flat out vec3 colour;
flat out vec3 around;
void main() {{
    colour = ramp[shade];
    around = vec3(disc.xy, max(disc.z, least));
    vec2 at = disc.xy + corner * (around.z + 1.0);
    gl_Position = on_screen(clamp(at, vec2(-4.0), size + 4.0));
}}
""",
    f"""#version 330
uniform vec2 size;
flat in vec3 colour;
flat in vec3 around;
out vec4 fragment;
void main() {{
    vec2 from = vec2(gl_FragCoord.x, size.y - gl_FragCoord.y) - around.xy;
    float radius = around.z, cover = 0.0, light = 1.0;
    if (radius < {POINT_RADIUS}) {{
        vec2 near = max(1.0 - abs(from), 0.0);
        cover = 3.14159265 * radius * radius * near.x * near.y;
    }} else if (radius < {RIM_FROM}) {{
        for (int k = 0; k < 16; k++) {{
            vec2 sample_at = from + (vec2(k % 4, k / 4) - 1.5) / 4.0;
            cover += clamp(4.0 * (radius - length(sample_at)) + 0.5, 0.0, 1.0) / 16.0;
        }}
    }} else {{
        float away = length(from);
        cover = clamp(radius + 0.5 - away, 0.0, 1.0);
        light = mix({RIM_SHADE}, 1.0, clamp((radius - away) / {RIM_WIDTH}, 0.0, 1.0));
    }}
    fragment = vec4(colour * light * cover, cover);
}}
""",
)

CIRCLE = (
    f"""{_HEAD}
in vec2 corner;
uniform vec3 disc;
uniform float width;
void main() {{
    vec2 at = disc.xy + corner * (disc.z + 0.5 * width + 1.0);
    gl_Position = on_screen(clamp(at, vec2(-4.0), size + 4.0));
}}
""",
    """#version 330
uniform vec2 size;
uniform vec3 disc;
uniform float width;
uniform vec3 colour;
out vec4 fragment;
void main() {
    float away = length(vec2(gl_FragCoord.x, size.y - gl_FragCoord.y) - disc.xy);
    float cover = clamp(disc.z + 0.5 - away, 0.0, 1.0);
    if (width > 0.0) cover = clamp(0.5 * width + 0.5 - abs(away - disc.z + 0.5 * width), 0.0, 1.0);
    fragment = vec4(colour, 1.0) * cover;
}
""",
)

BOX = (
    f"""{_HEAD}
in vec2 corner;
in vec4 box;
in vec3 tint;
flat out vec3 colour;
void main() {{
    colour = tint;
    gl_Position = on_screen(mix(box.xy, box.zw, 0.5 * corner + 0.5));
}}
""",
    """#version 330
flat in vec3 colour;
out vec4 fragment;
void main() { fragment = vec4(colour, 1.0); }
""",
)

LINE = (
    f"""{_HEAD}
in vec2 corner;
in vec4 ends;
in vec4 tint;
uniform float width;
flat out vec4 colour;
out float across;
void main() {{
    vec2 along = ends.zw - ends.xy;
    float far = length(along);
    along = far > 0.0 ? along / far : vec2(1.0, 0.0);
    across = corner.y * (0.5 * width + 1.0);
    vec2 at = (corner.x < 0.0 ? ends.xy : ends.zw) + corner.x * 0.5 * along;
    colour = tint;
    gl_Position = on_screen(at + across * vec2(-along.y, along.x));
}}
""",
    """#version 330
uniform float width;
flat in vec4 colour;
in float across;
out vec4 fragment;
void main() {
    float cover = clamp(0.5 * width + 0.5 - abs(across), 0.0, 1.0) * colour.a;
    fragment = vec4(colour.rgb * cover, cover);
}
""",
)

SHEET = (
    f"""{_HEAD}
in vec2 corner;
uniform vec4 box;
out vec2 at;
void main() {{
    at = 0.5 * corner + 0.5;
    gl_Position = on_screen(mix(box.xy, box.zw, at));
}}
""",
    """#version 330
uniform sampler2D picture;
in vec2 at;
out vec4 fragment;
void main() {
    vec4 colour = texture(picture, at);
    fragment = vec4(colour.rgb * colour.a, colour.a);
}
""",
)
