"""Draws Dear ImGui's draw lists with moderngl (imgui-bundle's own backends would need PyOpenGL)."""

from __future__ import annotations

import ctypes
from typing import TYPE_CHECKING, Any

if TYPE_CHECKING:
    import moderngl

_VERTEX = """#version 330
uniform vec2 display_size;
in vec2 in_position;
in vec2 in_texture;
in vec4 in_color;
out vec2 v_texture;
out vec4 v_color;
void main() {
    v_texture = in_texture;
    v_color = in_color;
    vec2 share = in_position / display_size;
    gl_Position = vec4(2.0 * share.x - 1.0, 1.0 - 2.0 * share.y, 0.0, 1.0);
}
"""

_FRAGMENT = """#version 330
uniform sampler2D glyphs;
in vec2 v_texture;
in vec4 v_color;
out vec4 out_color;
void main() {
    out_color = v_color * texture(glyphs, v_texture);
}
"""


class ImguiRenderer:
    """Belongs to the ImGui context that is current when it is made."""

    def __init__(self, context: moderngl.Context) -> None:
        from imgui_bundle import imgui

        io = imgui.get_io()
        io.backend_flags |= imgui.BackendFlags_.renderer_has_textures.value
        self._context: Any = context
        self._program = context.program(vertex_shader=_VERTEX, fragment_shader=_FRAGMENT)
        self._textures: dict[int, moderngl.Texture] = {}
        self._vertices = context.buffer(reserve=1 << 16, dynamic=True)
        self._indices = context.buffer(reserve=1 << 14, dynamic=True)
        self._array = self._vertex_array()

    def draw(self, framebuffer: Any) -> None:
        """Draw the finished ImGui frame over what the moderngl `framebuffer` holds already."""
        from imgui_bundle import imgui

        self._refresh_textures()
        data = imgui.get_draw_data()
        scale = data.framebuffer_scale
        width = round(data.display_size[0] * scale[0])
        height = round(data.display_size[1] * scale[1])
        context = self._context
        framebuffer.use()
        framebuffer.viewport = (0, 0, width, height)
        context.enable_only(context.BLEND)
        context.blend_equation = context.FUNC_ADD
        context.blend_func = (
            context.SRC_ALPHA,
            context.ONE_MINUS_SRC_ALPHA,
            context.ONE,
            context.ONE_MINUS_SRC_ALPHA,
        )
        self._program["display_size"] = tuple(data.display_size)
        for draw_list in data.cmd_lists:
            self._upload(draw_list)
            for command in draw_list.cmd_buffer:
                left, top, right, bottom = command.clip_rect
                x, y = int(left * scale[0]), int(height - bottom * scale[1])
                framebuffer.scissor = (
                    max(x, 0),
                    max(y, 0),
                    max(int((right - left) * scale[0]), 0),
                    max(int((bottom - top) * scale[1]), 0),
                )
                self._textures[command.tex_ref.get_tex_id()].use()
                self._array.render(
                    context.TRIANGLES, vertices=command.elem_count, first=command.idx_offset
                )
        framebuffer.scissor = None
        context.disable(context.BLEND)

    def release(self) -> None:
        for texture in self._textures.values():
            texture.release()
        for part in (self._array, self._vertices, self._indices, self._program):
            part.release()

    def _vertex_array(self) -> moderngl.VertexArray:
        from imgui_bundle import imgui

        return self._context.vertex_array(
            self._program,
            [(self._vertices, "2f 2f 4f1", "in_position", "in_texture", "in_color")],
            self._indices,
            index_element_size=imgui.INDEX_SIZE,
        )

    def _upload(self, draw_list: Any) -> None:
        from imgui_bundle import imgui

        vertices = _bytes(draw_list.vtx_buffer, imgui.VERTEX_SIZE)
        indices = _bytes(draw_list.idx_buffer, imgui.INDEX_SIZE)
        for buffer, content in ((self._vertices, vertices), (self._indices, indices)):
            # A fresh store each time: the GPU may still be reading the last one.
            buffer.orphan(max(buffer.size, 2 * len(content) if len(content) > buffer.size else 0))
            buffer.write(content)

    def _refresh_textures(self) -> None:
        """Do what ImGui asks of its glyph textures: it bakes glyphs as they are first needed."""
        from imgui_bundle import imgui

        status = imgui.ImTextureStatus
        for request in imgui.get_platform_io().textures:
            if request.status == status.want_create:
                texture = self._context.texture((request.width, request.height), 4)
                self._textures[texture.glo] = texture
                request.set_tex_id(texture.glo)
            if request.status in (status.want_create, status.want_updates):
                self._textures[request.tex_id].write(request.get_pixels_array().tobytes())
                request.set_status(status.ok)
            elif request.status == status.want_destroy:
                self._textures.pop(request.tex_id).release()
                request.set_tex_id(0)
                request.set_status(status.destroyed)


def _bytes(vector: Any, size: int) -> bytes:
    return ctypes.string_at(vector.data_address(), vector.size() * size) if vector.size() else b""
