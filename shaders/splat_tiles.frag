// The least depth of the nearest surface in each tile of the picture where it ends in it.
#include "depth.glsl"

uniform sampler2D front;  // relative depths of the nearest surface
uniform sampler2D light;  // times cover, cover
out float out_end;

void main() {
    ivec2 corner = ivec2(gl_FragCoord.xy) * TILE, last = textureSize(front, 0) - 1;
    out_end = NOTHING;
    for (int i = 0; i < TILE * TILE; ++i) {
        ivec2 texel = min(corner + ivec2(i % TILE, i / TILE), last);
        bool ends = texelFetch(light, texel, 0).a < 1.0;
        out_end = ends ? min(out_end, texelFetch(front, texel, 0).r) : out_end;
    }
}
