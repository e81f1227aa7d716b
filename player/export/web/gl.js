// A thin layer over WebGL 2: programs from the shaders of the player's window, uniforms, textures and
// framebuffers.

const HEADER = `#version 300 es
precision highp float;
precision highp int;
precision highp sampler2D;
`;

class Graphics {
    // shaders: GLSL sources without a version by their file names.
    constructor(canvas, shaders) {
        const gl = canvas.getContext("webgl2", {
            alpha: false, depth: false, antialias: false, powerPreference: "high-performance",
        });
        if (!gl) throw new Error("This browser has no WebGL 2, or it is switched off.");
        const float32 = gl.getExtension("EXT_color_buffer_float") && gl.getExtension("EXT_float_blend");
        if (!float32 && !gl.getExtension("EXT_color_buffer_half_float")) {
            throw new Error("This graphics card can't draw into floating-point textures.");
        }
        Object.assign(this, { gl, shaders, programs: new Map() });
        this.depthFormat = float32 ? gl.R32F : gl.R16F;
    }

    // Start the compilation of a program; `use` waits for its end.
    program(vertex, fragment, definitions = {}) {
        const gl = this.gl, key = JSON.stringify([vertex, fragment, definitions]);
        if (this.programs.has(key)) return this.programs.get(key);
        const macros = Object.entries(definitions).map(([name, value]) => `#define ${name} ${value}\n`);
        const program = gl.createProgram(), names = [`${vertex}.vert`, `${fragment}.frag`];
        const shaders = [gl.VERTEX_SHADER, gl.FRAGMENT_SHADER].map((kind, i) => {
            const shader = gl.createShader(kind);
            gl.shaderSource(shader, [HEADER, ...macros, this.shaders[names[i]]].join(""));
            gl.compileShader(shader);
            gl.attachShader(program, shader);
            return shader;
        });
        gl.linkProgram(program);
        const entry = { program, shaders, names, uniforms: null };
        this.programs.set(key, entry);
        return entry;
    }

    // Use a program, and set its uniforms; each of its textures has a unit of its own.
    use(entry, values) {
        const gl = this.gl;
        entry.uniforms ||= this.uniformsOf(entry);
        gl.useProgram(entry.program);
        for (const [name, { type, location, unit }] of entry.uniforms) {
            const value = values[name];
            if (value === undefined) throw new Error(`${entry.names}: ${name} is not given`);
            if (type === gl.SAMPLER_2D) {
                gl.activeTexture(gl.TEXTURE0 + unit);
                gl.bindTexture(gl.TEXTURE_2D, value);
                gl.uniform1i(location, unit);
            } else if (type === gl.FLOAT_MAT4) gl.uniformMatrix4fv(location, false, value);
            else if (type === gl.FLOAT) gl.uniform1fv(location, [value].flat());
            else if (type === gl.FLOAT_VEC2) gl.uniform2fv(location, value.flat());
            else if (type === gl.FLOAT_VEC3) gl.uniform3fv(location, value);
            else if (type === gl.INT_VEC2) gl.uniform2iv(location, value.flat());
            else gl.uniform1i(location, value);
        }
    }

    // The active uniforms of a program by name; throws an Error with the logs if linking failed.
    uniformsOf({ program, shaders, names }) {
        const gl = this.gl, uniforms = new Map();
        let units = 0;
        if (!gl.getProgramParameter(program, gl.LINK_STATUS) && !gl.isContextLost()) {
            const logs = shaders.map((shader, i) => `${names[i]}: ${gl.getShaderInfoLog(shader)}`);
            throw new Error([...logs, gl.getProgramInfoLog(program)].join("\n"));
        }
        for (let i = 0; i < gl.getProgramParameter(program, gl.ACTIVE_UNIFORMS); ++i) {
            const { name, type } = gl.getActiveUniform(program, i);
            const unit = type === gl.SAMPLER_2D ? units++ : null;
            const location = gl.getUniformLocation(program, name);
            uniforms.set(name.replace("[0]", ""), { type, location, unit });
        }
        return uniforms;
    }

    // Run a fragment shader over all pixels of a target.
    run(target, fragment, uniforms, definitions = { SUPERSAMPLE: 1 }) {
        this.bind(target);
        this.use(this.program("fullscreen", fragment, definitions), uniforms);
        this.gl.drawArrays(this.gl.TRIANGLES, 0, 3);
    }

    // Draw into a target from now on, after filling its textures with a colour, if one is given.
    bind({ framebuffer, width, height, textures }, ...color) {
        this.gl.bindFramebuffer(this.gl.FRAMEBUFFER, framebuffer);
        this.gl.viewport(0, 0, width, height);
        if (color.length) textures.forEach((_, i) => this.gl.clearBufferfv(this.gl.COLOR, i, color));
    }

    // Create a framebuffer with textures of some formats, and a new or an existing depth buffer.
    target(width, height, formats, { linear = false, depth = this.gl.createRenderbuffer() } = {}) {
        const gl = this.gl, framebuffer = gl.createFramebuffer();
        gl.bindFramebuffer(gl.FRAMEBUFFER, framebuffer);
        const attachments = formats.map((_, i) => gl.COLOR_ATTACHMENT0 + i);
        const textures = formats.map((format) => this.texture(width, height, format, linear));
        textures.forEach((texture, i) =>
            gl.framebufferTexture2D(gl.FRAMEBUFFER, attachments[i], gl.TEXTURE_2D, texture, 0));
        gl.drawBuffers(attachments);
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
