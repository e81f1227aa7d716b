// A small picture over the whole canvas.

in vec2 v_at;
uniform sampler2D source;
out vec4 out_color;

void main() {
    out_color = texture(source, v_at);
}
