// WebGL 2 in a few words: programs from the shaders that the player's window is drawn with, the
// uniforms that they ask for, and textures to draw into.

const HEAD = `#version 300 es
precision highp float;
precision highp int;
precision highp sampler2D;
`;

class Graphics {
    // shaders: file name -> GLSL without its version.
    constructor(canvas, shaders) {
        const gl = canvas.getContext("webgl2", {
            alpha: false, depth: false, antialias: false, powerPreference: "high-performance",
        });
        if (!gl) throw new Error("This browser has no WebGL 2, or it is switched off.");
        const whole = gl.getExtension("EXT_color_buffer_float") && gl.getExtension("EXT_float_blend");
        if (!whole && !gl.getExtension("EXT_color_buffer_half_float")) {
            throw new Error("This graphics card can't draw into floating-point textures.");
        }
        Object.assign(this, { gl, shaders, programs: new Map() });
        this.depth = whole ? gl.R32F : gl.R16F;
    }

    // Begins to compile; `use` waits for it.
    program(vertex, fragment, definitions = {}) {
        const gl = this.gl, key = JSON.stringify([vertex, fragment, definitions]);
        if (this.programs.has(key)) return this.programs.get(key);
        const defined = Object.entries(definitions).map(([name, value]) => `#define ${name} ${value}\n`);
        const program = gl.createProgram(), names = [`${vertex}.vert`, `${fragment}.frag`];
        const shaders = [gl.VERTEX_SHADER, gl.FRAGMENT_SHADER].map((kind, i) => {
            const shader = gl.createShader(kind);
            gl.shaderSource(shader, [HEAD, ...defined, this.shaders[names[i]]].join(""));
            gl.compileShader(shader);
            gl.attachShader(program, shader);
            return shader;
        });
        gl.linkProgram(program);
        const made = { program, shaders, names, uniforms: null };
        this.programs.set(key, made);
        return made;
    }

    // Set the uniforms that a program has; each of its textures has a unit of its own.
    use(made, values) {
        const gl = this.gl;
        made.uniforms ||= this.linked(made);
        gl.useProgram(made.program);
        for (const [name, { type, at, unit }] of made.uniforms) {
            const value = values[name];
            if (value === undefined) throw new Error(`${made.names}: ${name} is not given`);
            if (type === gl.SAMPLER_2D) {
                gl.activeTexture(gl.TEXTURE0 + unit);
                gl.bindTexture(gl.TEXTURE_2D, value);
                gl.uniform1i(at, unit);
            } else if (type === gl.FLOAT_MAT4) gl.uniformMatrix4fv(at, false, value);
            else if (type === gl.FLOAT) gl.uniform1fv(at, [value].flat());
            else if (type === gl.FLOAT_VEC2) gl.uniform2fv(at, value.flat());
            else if (type === gl.FLOAT_VEC3) gl.uniform3fv(at, value);
            else if (type === gl.INT_VEC2) gl.uniform2iv(at, value.flat());
            else gl.uniform1i(at, value);
        }
    }

    linked({ program, shaders, names }) {
        const gl = this.gl, uniforms = new Map();
        let units = 0;
        if (!gl.getProgramParameter(program, gl.LINK_STATUS) && !gl.isContextLost()) {
            const logs = shaders.map((shader, i) => `${names[i]}: ${gl.getShaderInfoLog(shader)}`);
            throw new Error([...logs, gl.getProgramInfoLog(program)].join("\n"));
        }
        for (let i = 0; i < gl.getProgramParameter(program, gl.ACTIVE_UNIFORMS); ++i) {
            const { name, type } = gl.getActiveUniform(program, i);
            const unit = type === gl.SAMPLER_2D ? units++ : null, at = gl.getUniformLocation(program, name);
            uniforms.set(name.replace("[0]", ""), { type, at, unit });
        }
        return uniforms;
    }

    // One pass over all of a target.
    fill(target, fragment, uniforms, definitions) {
        this.into(target);
        this.use(this.program("fullscreen", fragment, definitions), uniforms);
        this.gl.drawArrays(this.gl.TRIANGLES, 0, 3);
    }

    into({ framebuffer, width, height }) {
        this.gl.bindFramebuffer(this.gl.FRAMEBUFFER, framebuffer);
        this.gl.viewport(0, 0, width, height);
    }

    // Textures of some formats to draw into, and a depth buffer: a new one, or that of another target.
    target(width, height, formats, { linear = false, depth = this.gl.createRenderbuffer() } = {}) {
        const gl = this.gl, framebuffer = gl.createFramebuffer();
        gl.bindFramebuffer(gl.FRAMEBUFFER, framebuffer);
        const places = formats.map((_, i) => gl.COLOR_ATTACHMENT0 + i);
        const textures = formats.map((format) => this.texture(width, height, format, linear));
        textures.forEach((texture, i) =>
            gl.framebufferTexture2D(gl.FRAMEBUFFER, places[i], gl.TEXTURE_2D, texture, 0));
        gl.drawBuffers(places);
        gl.bindRenderbuffer(gl.RENDERBUFFER, depth);
        gl.renderbufferStorage(gl.RENDERBUFFER, gl.DEPTH_COMPONENT24, width, height);
        gl.framebufferRenderbuffer(gl.FRAMEBUFFER, gl.DEPTH_ATTACHMENT, gl.RENDERBUFFER, depth);
        return { width, height, framebuffer, textures, depth };
    }

    texture(width, height, format, linear = false) {
        const gl = this.gl, texture = gl.createTexture(), filter = linear ? gl.LINEAR : gl.NEAREST;
        gl.bindTexture(gl.TEXTURE_2D, texture);
        gl.texStorage2D(gl.TEXTURE_2D, 1, format, width, height);
        for (const [name, value] of [
            [gl.TEXTURE_MIN_FILTER, filter], [gl.TEXTURE_MAG_FILTER, filter],
            [gl.TEXTURE_WRAP_S, gl.CLAMP_TO_EDGE], [gl.TEXTURE_WRAP_T, gl.CLAMP_TO_EDGE],
        ]) gl.texParameteri(gl.TEXTURE_2D, name, value);
        return texture;
    }

    release({ framebuffer, textures, depth }) {
        this.gl.deleteFramebuffer(framebuffer);
        this.gl.deleteRenderbuffer(depth);
        textures.forEach((texture) => this.gl.deleteTexture(texture));
    }
}
