// Draws a clip at a time: the depth of the nearest surface; the movers on it summed as soft discs;
// the distances smoothed; the shadow on the floor; light and background. Two passes over the movers,
// or while things move on a slow machine one, in which the nearest disc alone counts.

const DISC = 2.3;       // natural disc radius in closing distances
const THICKNESS = 1.6;  // depth, in disc radii, over which discs count as one surface
const SHADOW_SIDE = 192, SHADOWING = 30000;  // texels a side; movers that are enough for it
const SHADOW_EVERY = 4;  // pictures, while things move on a slow machine
const BUDGET = 384 << 20;  // bytes of movers kept on the GPU
const SENT = 1 << 20;  // bytes sent there in one go
const UNPACKING = 0.8;  // of the time that loading takes

class Renderer {
    // shaders: name -> GLSL; throws an Error whose message is for people.
    constructor(canvas, clip, shaders) {
        const options = { alpha: false, depth: false, antialias: false, desynchronized: false };
        const gl = canvas.getContext("webgl2", { ...options, powerPreference: "high-performance" });
        if (!gl) throw new Error("This browser has no WebGL 2, or it is switched off.");
        const full = gl.getExtension("EXT_color_buffer_float");
        if (!full && !gl.getExtension("EXT_color_buffer_half_float")) {
            throw new Error("This graphics card can't draw into floating-point textures.");
        }
        this.fine = full && gl.getExtension("EXT_float_blend");
        Object.assign(this, { gl, clip, shaders, canvas });
        this.programs = new Map();
        this.buffers = new Map();  // by interval, the longest unused first
        this.loading = new Map();
        this.done = new Map();  // shares of what is loading
        this.begun = new Map();  // programs that are being compiled
        this.parallel = gl.getExtension("KHR_parallel_shader_compile");
        this.used = 0;
        this.empty = gl.createVertexArray();
        this.targets = null;
        this.shadowDay = null;
        this.shadowAge = Infinity;  // in pictures
        this.palette = this.makePalette();
        this.shadows = [0, 1].map(() => this.target(
            SHADOW_SIDE, SHADOW_SIDE, [gl.RG16F], gl.LINEAR));
    }

    // Fetch an interval to the GPU; true once it is there.
    ready(index) {
        const there = this.buffers.get(index);
        if (there) {
            this.buffers.delete(index);
            this.buffers.set(index, there);
            return true;
        }
        if (!this.loading.has(index)) {
            const told = (share) => this.done.set(index, UNPACKING * share);
            const work = this.clip.load(index, told).then((data) => this.upload(index, data));
            this.loading.set(index, work.finally(() => this.loading.delete(index)));
        }
        return false;
    }

    async wait(index) {
        while (!this.ready(index)) await this.loading.get(index);
    }

    // Share of an interval that is loaded.
    share(index) {
        return this.buffers.has(index) ? 1 : this.done.get(index) || 0;
    }

    async upload(index, { points, tracks, colors }) {
        const gl = this.gl, { degree } = this.clip.intervals[index];
        const stored = [], all = [...points, tracks, ...colors];
        const whole = all.reduce((sum, data) => sum + data.byteLength, 0);
        let bytes = 0;
        const store = async (location, data, size, point) => {
            const buffer = gl.createBuffer(), raw = new Uint8Array(data.buffer);
            gl.bindBuffer(gl.ARRAY_BUFFER, buffer);
            gl.bufferData(gl.ARRAY_BUFFER, raw.length, gl.STATIC_DRAW);
            for (let at = 0; at < raw.length; at += SENT) {
                const part = raw.subarray(at, at + SENT);
                gl.bindBuffer(gl.ARRAY_BUFFER, buffer);
                gl.bufferSubData(gl.ARRAY_BUFFER, at, part);
                bytes += part.length;
                this.done.set(index, UNPACKING + ((1 - UNPACKING) * bytes) / whole);
                await nextTurn();
            }
            stored.push({ location, buffer, size, point });
        };
        for (const [i, data] of points.entries()) {
            await store(i, data, 6, (at, stride) =>
                gl.vertexAttribPointer(at, 3, gl.UNSIGNED_SHORT, false, stride, 0));
        }
        const wide = tracks.BYTES_PER_ELEMENT, kind = wide === 2 ? gl.UNSIGNED_SHORT : gl.UNSIGNED_INT;
        await store(4, tracks, wide, (at, stride) =>
            gl.vertexAttribIPointer(at, 1, kind, stride, 0));
        for (const [i, data] of colors.entries()) {
            await store(5 + i, data, 3, (at, stride) =>
                gl.vertexAttribPointer(at, 3, gl.UNSIGNED_BYTE, true, stride, 0));
        }
        const colored = colors.length > 0, arrays = new Map();
        this.buffers.set(index, { arrays, stored, bytes, degree, colored });
        this.used += bytes;
        for (const [old, { arrays, stored, bytes }] of this.buffers) {
            if (this.used <= BUDGET || this.buffers.size <= 3) break;
            arrays.forEach((array) => gl.deleteVertexArray(array));
            stored.forEach(({ buffer }) => gl.deleteBuffer(buffer));
            this.buffers.delete(old);
            this.used -= bytes;
        }
    }

    // The interval's movers as the shaders' inputs, one of so many. Neighbours in the buffers are
    // neighbours on the plant, so what is left out leaves no gaps.
    array(index, every) {
        const gl = this.gl, { arrays, stored } = this.buffers.get(index);
        if (!arrays.has(every)) {
            arrays.set(every, gl.createVertexArray());
            gl.bindVertexArray(arrays.get(every));
            for (const { location, buffer, size, point } of stored) {
                gl.bindBuffer(gl.ARRAY_BUFFER, buffer);
                gl.enableVertexAttribArray(location);
                point(location, every * size);
            }
        }
        return arrays.get(every);
    }

    count(day) {
        return this.clip.intervals[this.clip.locate(day)[0]].count;
    }

    // Of how many movers one may be left at a time when `wanted` are enough: 1, 2, 4, ... 32.
    thinned(day, wanted) {
        return 2 ** Math.min(Math.max(Math.floor(Math.log2(this.count(day) / wanted)), 0), 5);
    }

    // look: { light, byTrack, chosen, pointSize, eyeDome, depthCue, floor };
    // every: of so many movers one is drawn; quick: in one pass, without soft rims.
    draw(day, camera, look, size, every = 1, quick = false) {
        for (const _ of this.steps(day, camera, look, size, every, quick)) continue;
    }

    // What is drawn smaller than the canvas is enlarged: a canvas of another size has to be emptied,
    // and whoever does that waits for all that is being drawn.
    resize([width, height]) {
        if (this.canvas.width !== width || this.canvas.height !== height) {
            Object.assign(this.canvas, { width, height });
        }
    }

    // The same, step by step, at most slice() movers in each; what is shown changes in the last one.
    // Nothing else may be drawn in between: begin anew after that.
    *steps(day, camera, look, size, every = 1, quick = false, slice = () => Infinity) {
        const [width, height] = size;
        if (!this.targets || this.targets.width !== width || this.targets.height !== height) {
            this.release(this.targets);
            this.targets = this.makeTargets(width, height);
        }
        const layers = this.clip.layersAt(day).filter((layer) => this.buffers.has(layer.interval));
        const disc = {
            radius: (DISC * look.pointSize * this.clip.closingAt(day)) * Math.sqrt(every),
            magnification: height / (2 * Math.tan(camera.fieldOfView / 2)),
            smallest: 1.5,
            scale: camera.radius,
            middle: camera.distance,
        };
        yield* this.drawSurface(layers, camera, look, disc, every, quick, slice);
        this.smooth(disc);
        yield;
        this.castShadow(day, layers, quick ? SHADOW_EVERY : 1);
        yield;
        this.compose(camera, look, disc);
    }

    *drawSurface(layers, camera, look, disc, every, quick, slice) {
        const gl = this.gl, { surface, width, height } = this.targets;
        const seen = {
            ...disc, view: camera.view(), projection: camera.projection(width / height),
        };
        this.into(surface);
        gl.disable(gl.BLEND);
        gl.enable(gl.DEPTH_TEST);
        gl.depthMask(true);
        gl.colorMask(true, true, true, true);
        gl.clearBufferfv(gl.COLOR, 0, [0, 0, 0, 0]);
        gl.clearBufferfv(gl.COLOR, 1, [0, 0, 0, 0]);
        gl.clearBufferfv(gl.DEPTH, 0, [1]);
        gl.depthFunc(gl.LESS);
        const paint = {
            ...seen, palette: [this.palette, 0], by_track: look.byTrack, chosen: look.chosen,
        };
        if (quick) {
            yield* this.drawSlices("splat", "nearest", layers, paint, every, slice);
            gl.disable(gl.DEPTH_TEST);
            return;
        }
        gl.colorMask(false, false, false, false);
        const near = { ...seen, thickness: THICKNESS };
        yield* this.drawSlices("surface", "surface", layers, near, every, slice);
        gl.colorMask(true, true, true, true);
        gl.depthMask(false);
        gl.enable(gl.BLEND);
        gl.blendFunc(gl.ONE, gl.ONE);
        yield* this.drawSlices("splat", "splat", layers, paint, every, slice);
        gl.disable(gl.BLEND);
        gl.disable(gl.DEPTH_TEST);
    }

    smooth(disc) {
        const { surface, distances } = this.targets;
        const [colors, sums] = surface.textures;
        const steps = [[sums, distances[0], [1, 0]], [distances[0].textures[0], distances[1], [0, 1]]];
        for (const [source, target, direction] of steps) {
            this.into(target);
            this.fill("smooth", {
                ...disc, source: [source, 0], color_sum: [colors, 1], direction,
                first: source === sums,
            });
        }
    }

    // patience: pictures that may pass before a shadow follows its plant.
    castShadow(day, layers, patience) {
        const ready = layers.map((layer) => layer.interval).join();
        if (this.shadowDay === `${day} ${ready}` || ++this.shadowAge < patience) return;
        this.shadowDay = `${day} ${ready}`;
        this.shadowAge = 0;
        const gl = this.gl, clip = this.clip, [first, second] = this.shadows;
        const every = this.thinned(day, SHADOWING);
        const texel = (2 * clip.floorSide) / SHADOW_SIDE;
        const area = 4 * clip.closingAt(day) ** 2 * clip.pointsAMover(day);
        this.into(first);
        gl.clearBufferfv(gl.COLOR, 0, [0, 0, 0, 0]);
        gl.enable(gl.BLEND);
        gl.blendFunc(gl.ONE, gl.ONE);
        this.drawMovers("shadow", "shadow", layers, {
            from_above: this.fromAbove(), reach: 0.12 * clip.floorSide,
            cover: (area / texel ** 2) * every,
        }, every);
        gl.disable(gl.BLEND);
        for (const [source, target, direction] of [[first, second, [1, 0]], [second, first, [0, 1]]]) {
            this.into(target);
            this.fill("blur", {
                source: [source.textures[0], 0], saturate: source === first,
                direction: scaled([...direction, 0], 1 / SHADOW_SIDE).slice(0, 2),
            });
        }
    }

    compose(camera, look, disc) {
        const gl = this.gl, clip = this.clip, { surface, distances, width, height } = this.targets;
        const slope = Math.tan(camera.fieldOfView / 2);
        const rows = camera.frame(), up = camera.axes[2];
        const whole = { framebuffer: null, width: this.canvas.width, height: this.canvas.height };
        const smaller = width !== whole.width || height !== whole.height;
        if (smaller && !this.targets.picture) {
            this.targets.picture = this.target(width, height, [gl.RGBA8], gl.LINEAR);
        }
        this.into(smaller ? this.targets.picture : whole);
        this.fill("picture", {
            ...disc, ...clip.grounds[look.light ? "light" : "dark"],
            color_sum: [surface.textures[0], 0], distances: [distances[1].textures[0], 1],
            shadow: [this.shadows[0].textures[0], 2],
            half_field: [(slope * width) / height, slope],
            to_floor: product(this.fromAbove(), inverse(rows, camera)),
            sky: rows.map((row) => dot(row, up)),
            dome_radius: Math.max(1, (1.2 * height) / 720), eye_dome: look.eyeDome,
            depth_cue: look.depthCue, floor_share: look.floor,
        });
        if (smaller) {
            this.into(whole);
            this.fill("enlarge", { source: [this.targets.picture.textures[0], 0] });
        }
    }

    // Local coordinates to the floor's square, [-1, 1] x [-1, 1] x height above the floor.
    fromAbove() {
        const { up, middle, floor, floorSide } = this.clip, [a, b, c] = axesOf(up), s = floorSide;
        return [
            a[0] / s, b[0] / s, c[0], 0, a[1] / s, b[1] / s, c[1], 0, a[2] / s, b[2] / s, c[2], 0,
            -middle[0] / s, -middle[1] / s, -floor, 1,
        ];
    }

    // The positions of all layers at a time, read back from the GPU: for tests.
    positions(day) {
        const gl = this.gl, found = [];
        for (const layer of this.clip.layersAt(day)) {
            const result = gl.createBuffer(), count = layer.group.count;
            const values = new Float32Array(3 * count), { degree } = this.buffers.get(layer.interval);
            gl.bindBuffer(gl.TRANSFORM_FEEDBACK_BUFFER, result);
            gl.bufferData(gl.TRANSFORM_FEEDBACK_BUFFER, values.byteLength, gl.STREAM_READ);
            gl.bindBufferBase(gl.TRANSFORM_FEEDBACK_BUFFER, 0, result);
            gl.enable(gl.RASTERIZER_DISCARD);
            this.drawMovers("positions", "nothing", [layer], {}, 1, true);
            gl.disable(gl.RASTERIZER_DISCARD);
            gl.bindBufferBase(gl.TRANSFORM_FEEDBACK_BUFFER, 0, null);
            gl.bindBuffer(gl.TRANSFORM_FEEDBACK_BUFFER, result);
            gl.getBufferSubData(gl.TRANSFORM_FEEDBACK_BUFFER, 0, values);
            gl.deleteBuffer(result);
            found.push({ degree, litter: layer.interval !== this.clip.locate(day)[0], values });
        }
        return found;
    }

    drawMovers(vertex, fragment, layers, uniforms, every, feedback = false) {
        const whole = () => Infinity;
        const slices = this.drawSlices(vertex, fragment, layers, uniforms, every, whole, feedback);
        for (const _ of slices) continue;
    }

    *drawSlices(vertex, fragment, layers, uniforms, every, slice, feedback = false) {
        const gl = this.gl;
        for (const layer of layers) {
            const { degree, colored } = this.buffers.get(layer.interval), { group } = layer;
            const { low, step } = this.clip.intervals[layer.interval];
            const stop = Math.ceil((group.first + group.count) / every);
            for (let first = Math.ceil(group.first / every); first < stop;) {
                const program = this.program(
                    vertex, fragment, { DEGREE: degree, SCAN_COLORS: +colored });
                this.use(program, {
                    ...uniforms, box_low: low, box_step: step, alpha: layer.alpha,
                    blend: layer.blend, weights: bernstein(degree, layer.parameter),
                });
                const count = Math.min(stop - first, slice());
                gl.bindVertexArray(this.array(layer.interval, every));
                if (feedback) gl.beginTransformFeedback(gl.POINTS);
                gl.drawArrays(gl.POINTS, first, count);
                if (feedback) gl.endTransformFeedback();
                gl.bindVertexArray(null);
                first += count;
                yield;
            }
        }
    }

    fill(name, uniforms) {
        this.use(this.program("screen", name, {}), uniforms);
        this.gl.bindVertexArray(this.empty);
        this.gl.drawArrays(this.gl.TRIANGLES, 0, 3);
    }

    // The picture's programs: begins them all, and finishes one at a time; true once they are there.
    // Compilers take long, and who asks too soon waits for them.
    compiled({ degree, colored }) {
        const movers = { DEGREE: degree, SCAN_COLORS: +colored };
        for (const [vertex, fragment] of [
            ["splat", "nearest"], ["surface", "surface"], ["splat", "splat"], ["shadow", "shadow"],
            ["screen", "smooth"], ["screen", "blur"], ["screen", "picture"], ["screen", "enlarge"],
        ]) {
            const definitions = vertex === "screen" ? {} : movers;
            if (!this.programs.has(keyOf(vertex, fragment, definitions))) {
                this.begin(vertex, fragment, definitions);
            }
        }
        const [next] = this.begun;
        if (!next) return true;
        const [key, begun] = next, done = this.parallel && this.parallel.COMPLETION_STATUS_KHR;
        if (!done || this.gl.getProgramParameter(begun.program, done)) this.finish(key);
        return false;
    }

    begin(vertex, fragment, definitions) {
        const key = keyOf(vertex, fragment, definitions);
        if (!this.begun.has(key)) {
            this.begun.set(key, compiling(this.gl, this.shaders, vertex, fragment, definitions));
        }
        return key;
    }

    finish(key) {
        this.programs.set(key, linked(this.gl, this.begun.get(key)));
        this.begun.delete(key);
    }

    program(vertex, fragment, definitions) {
        const key = keyOf(vertex, fragment, definitions);
        if (!this.programs.has(key)) this.finish(this.begin(vertex, fragment, definitions));
        return this.programs.get(key);
    }

    // Set the uniforms that the program has; a texture comes as [texture, unit].
    use({ program, uniforms }, values) {
        const gl = this.gl;
        gl.useProgram(program);
        for (const [name, value] of Object.entries(values)) {
            const found = uniforms.get(name);
            if (!found) continue;
            if (found.type === gl.SAMPLER_2D) {
                gl.activeTexture(gl.TEXTURE0 + value[1]);
                gl.bindTexture(gl.TEXTURE_2D, value[0]);
                gl.uniform1i(found.at, value[1]);
            } else {
                SETTERS(gl)[found.type](found.at, value);
            }
        }
    }

    makePalette() {
        const gl = this.gl, width = 1024, { tracks } = this.clip;
        const rows = Math.ceil(tracks.length / width), texels = new Uint8Array(4 * width * rows);
        tracks.forEach(({ color }, i) => texels.set([...color, 255], 4 * i));
        const texture = this.texture(gl.NEAREST);
        gl.texImage2D(
            gl.TEXTURE_2D, 0, gl.RGBA8, width, rows, 0, gl.RGBA, gl.UNSIGNED_BYTE, texels);
        return texture;
    }

    makeTargets(width, height) {
        const gl = this.gl, away = this.fine ? gl.R32F : gl.R16F;
        const surface = this.target(width, height, [gl.RGBA16F, away], gl.NEAREST);
        surface.depth = gl.createRenderbuffer();
        gl.bindRenderbuffer(gl.RENDERBUFFER, surface.depth);
        gl.renderbufferStorage(gl.RENDERBUFFER, gl.DEPTH_COMPONENT24, width, height);
        gl.framebufferRenderbuffer(
            gl.FRAMEBUFFER, gl.DEPTH_ATTACHMENT, gl.RENDERBUFFER, surface.depth);
        const distances = [0, 1].map(() => this.target(width, height, [away], gl.NEAREST));
        return { width, height, surface, distances, picture: null };
    }

    target(width, height, formats, filter) {
        const gl = this.gl, framebuffer = gl.createFramebuffer();
        gl.bindFramebuffer(gl.FRAMEBUFFER, framebuffer);
        const textures = formats.map((format, i) => {
            const texture = this.texture(filter);
            gl.texStorage2D(gl.TEXTURE_2D, 1, format, width, height);
            const point = gl.COLOR_ATTACHMENT0 + i;
            gl.framebufferTexture2D(gl.FRAMEBUFFER, point, gl.TEXTURE_2D, texture, 0);
            return texture;
        });
        gl.drawBuffers(formats.map((_, i) => gl.COLOR_ATTACHMENT0 + i));
        return { width, height, framebuffer, textures };
    }

    texture(filter) {
        const gl = this.gl, texture = gl.createTexture();
        gl.bindTexture(gl.TEXTURE_2D, texture);
        gl.texParameteri(gl.TEXTURE_2D, gl.TEXTURE_MIN_FILTER, filter);
        gl.texParameteri(gl.TEXTURE_2D, gl.TEXTURE_MAG_FILTER, filter);
        gl.texParameteri(gl.TEXTURE_2D, gl.TEXTURE_WRAP_S, gl.CLAMP_TO_EDGE);
        gl.texParameteri(gl.TEXTURE_2D, gl.TEXTURE_WRAP_T, gl.CLAMP_TO_EDGE);
        return texture;
    }

    into({ framebuffer, width, height }) {
        this.gl.bindFramebuffer(this.gl.FRAMEBUFFER, framebuffer);
        this.gl.viewport(0, 0, width, height);
    }

    release(targets) {
        if (!targets) return;
        const gl = this.gl;
        const { surface, distances, picture } = targets;
        for (const { framebuffer, textures } of [surface, ...distances, picture].filter(Boolean)) {
            gl.deleteFramebuffer(framebuffer);
            textures.forEach((texture) => gl.deleteTexture(texture));
        }
        gl.deleteRenderbuffer(targets.surface.depth);
    }
}

function keyOf(vertex, fragment, definitions) {
    return [vertex, fragment, ...Object.values(definitions)].join();
}

// Begins to compile; nothing is asked, so nothing is waited for.
function compiling(gl, shaders, vertex, fragment, definitions) {
    const head = [
        "#version 300 es", "precision highp float;", "precision highp int;",
        "precision highp sampler2D;",
        ...Object.entries(definitions).map(([name, value]) => `#define ${name} ${value}`), "",
    ].join("\n");
    const program = gl.createProgram(), parts = [];
    for (const [kind, name] of [[gl.VERTEX_SHADER, `${vertex}.vert`],
                                [gl.FRAGMENT_SHADER, `${fragment}.frag`]]) {
        const shader = gl.createShader(kind);
        gl.shaderSource(shader, head + shaders[name]);
        gl.compileShader(shader);
        gl.attachShader(program, shader);
        parts.push([name, shader]);
    }
    if (vertex === "positions") {
        gl.transformFeedbackVaryings(program, ["out_position"], gl.SEPARATE_ATTRIBS);
    }
    gl.linkProgram(program);
    return { program, parts };
}

function linked(gl, { program, parts }) {
    if (!gl.getProgramParameter(program, gl.LINK_STATUS) && !gl.isContextLost()) {
        const logs = parts.map(([name, shader]) => `${name}: ${gl.getShaderInfoLog(shader) || ""}`);
        throw new Error([...logs, gl.getProgramInfoLog(program)].join("\n"));
    }
    const uniforms = new Map();
    for (let i = 0; i < gl.getProgramParameter(program, gl.ACTIVE_UNIFORMS); ++i) {
        const { name, type } = gl.getActiveUniform(program, i);
        uniforms.set(name.replace("[0]", ""), { type, at: gl.getUniformLocation(program, name) });
    }
    return { program, uniforms };
}

const SETTERS = (gl) => ({
    [gl.FLOAT]: (at, v) => gl.uniform1fv(at, [].concat(v)),
    [gl.FLOAT_VEC2]: (at, v) => gl.uniform2fv(at, v),
    [gl.FLOAT_VEC3]: (at, v) => gl.uniform3fv(at, v),
    [gl.FLOAT_MAT4]: (at, v) => gl.uniformMatrix4fv(at, false, v),
    [gl.INT]: (at, v) => gl.uniform1i(at, v),
    [gl.BOOL]: (at, v) => gl.uniform1i(at, v ? 1 : 0),
    [gl.INT_VEC2]: (at, v) => gl.uniform2iv(at, v),
});

// The product of two column-major 4 x 4 matrices.
function product(a, b) {
    const result = new Array(16).fill(0);
    for (let column = 0; column < 4; ++column) {
        for (let row = 0; row < 4; ++row) {
            for (let k = 0; k < 4; ++k) {
                result[4 * column + row] += a[4 * k + row] * b[4 * column + k];
            }
        }
    }
    return result;
}

// From the eye's coordinates back to local ones, column-major.
function inverse([right, above, backward], camera) {
    const eye = sum(camera.target, scaled(backward, camera.distance));
    return [...right, 0, ...above, 0, ...backward, 0, ...eye, 1];
}
