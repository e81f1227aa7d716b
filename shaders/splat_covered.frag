// Nothing behind is to be seen where the nearest surface covers a sample: there the depth is 0.
uniform sampler2D colors;

void main() {
    gl_FragDepth = texelFetch(colors, ivec2(gl_FragCoord.xy), 0).a == 1.0 ? 0.0 : 1.0;
}
