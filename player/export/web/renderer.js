// Renders a clip at a time by the passes of the player's window: splats on the nearest surface,
// filtering of depths, shadow, lighting, and composition over the background.

const MAX_MEMORY = 384 << 20;  // bytes of points kept on the GPU
const TYPES = { Uint8Array: "UNSIGNED_BYTE", Uint16Array: "UNSIGNED_SHORT", Uint32Array: "UNSIGNED_INT" };

class Renderer {
    // shaders: see Graphics. Throws an Error, whose message is shown to users, without WebGL 2.
    constructor(canvas, clip, shaders) {
        const graphics = new Graphics(canvas, shaders), { gl } = graphics, { side } = clip.shadow;
        Object.assign(this, { graphics, gl, clip, canvas, targets: null, cachedPalette: {} });
        this.intervals = new Map();  // on the GPU, least recently used first
        this.shadows = [0, 1].map(() => graphics.target(side, side, [gl.RG16F], { linear: true }));
        this.ground = graphics.target(...clip.groundSize, [gl.RGBA16F], { linear: true });
        [, this.maxPointPx] = gl.getParameter(gl.ALIASED_POINT_SIZE_RANGE);
        clip.intervals.forEach((interval) => this.programs(interval));
        for (const name of ["splat_resolve", "bilateral", "shade", "blur", "ground", "picture"]) {
            graphics.program("fullscreen", name, { SUPERSAMPLE: 1 });
        }
    }

    // Whether an interval's points are on the GPU; if not, loading them is started.
    isReady(index) {
        const kept = this.intervals.get(index) || { columns: null, bytes: 0 };
        this.intervals.delete(index);
        this.intervals.set(index, kept);
        kept.loading ||= this.clip.load(index).then((data) => this.upload(kept, data));
        return kept.columns !== null;
    }

    upload(kept, { points, tracks, colors, normals }) {
        const gl = this.gl;
        const column = (location, data, components) => {
            const buffer = gl.createBuffer(), { name, BYTES_PER_ELEMENT } = data.constructor;
            gl.bindBuffer(gl.ARRAY_BUFFER, buffer);
            gl.bufferData(gl.ARRAY_BUFFER, data, gl.STATIC_DRAW);
            kept.bytes += data.byteLength;
            const size = components * BYTES_PER_ELEMENT;
            return { location, buffer, components, type: gl[TYPES[name]], size };
        };
        kept.array = gl.createVertexArray();
        kept.columns = [[points, 0, 3], [tracks, 4, 1], [colors, 5, 3], [normals, 7, 4]].flatMap(
            ([sequence, first, components]) => sequence.map((data, i) => column(first + i, data, components)));
        let used = [...this.intervals.values()].reduce((sum, { bytes }) => sum + bytes, 0);
        for (const [index, { array, columns, bytes }] of this.intervals) {
            if (used <= MAX_MEMORY || this.intervals.size <= 3) break;
            if (!columns) continue;
            gl.deleteVertexArray(array);
            columns.forEach(({ buffer }) => gl.deleteBuffer(buffer));
            this.intervals.delete(index);
            used -= bytes;
        }
    }

    // Bind every n-th point of an interval as vertex attributes; points in sequence are neighbours, so
    // that this leaves no gaps.
    bindPoints(index, stride) {
        const gl = this.gl, { array, columns } = this.intervals.get(index);
        gl.bindVertexArray(array);
        for (const { location, buffer, components, type, size } of columns) {
            gl.bindBuffer(gl.ARRAY_BUFFER, buffer);
            gl.enableVertexAttribArray(location);
            if (components === 1) gl.vertexAttribIPointer(location, 1, type, stride * size, 0);
            else gl.vertexAttribPointer(location, components, type, location > 4, stride * size, 0);
        }
    }

    // The largest stride, a power of 2 up to 32, that leaves `minimum` points of a time's interval.
    maxStride(day, minimum) {
        const { count } = this.clip.intervals[this.clip.locate(day)[0]];
        return 2 ** clamped(Math.floor(Math.log2(count / minimum)), 0, 5);
    }

    // look: { light, byTrack, selected, pointSize }; stride: every n-th point is drawn, with larger
    // splats; supersample: samples along each side of a pixel where splats are small.
    draw(day, camera, look, { stride = 1, supersample = 1 } = {}) {
        const { graphics, clip, gl } = this, { width, height } = this.canvas;
        const layers = clip.layersAt(day).filter(({ interval }) => this.intervals.get(interval)?.columns);
        const slope = Math.tan(camera.field_of_view / 2), pose = camera.pose(), view = pose.inverse();
        const { x, y, z } = view.transformPoint(new DOMPoint(...camera.axes[2], 0));
        const distance = clip.interpolate(clip.coverage, day), pixel = (2 * slope * camera.distance) / height;
        const radius = clip.splat.radii * look.pointSize * Math.sqrt(stride) * distance;
        const samples = radius > clip.splat.small * pixel ? 1 : supersample;
        const values = {
            radius, ...clip.uniforms, ...clip.grounds[look.light ? "light" : "dark"],
            view: view.toFloat32Array(), projection: camera.projection(width / height),
            focal_px: (samples * height) / (2 * slope),
            point_px_range: [samples * clip.splat.smallest, this.maxPointPx],
            target_depth: camera.distance,
            half_extent: [(slope * width) / height, slope],
            by_track: look.byTrack, palette: this.palette(look.selected, day),
            to_floor: new DOMMatrix(clip.shadow.toSquare).multiply(pose).toFloat32Array(),
            up_dir: [x, y, z],
        };
        const targets = this.targetsOf(samples * width, samples * height);
        const { nearest, sums, surface, filtered, lit } = targets;
        const pass = (target, name, uniforms) =>
            graphics.run(target, name, { ...values, ...uniforms }, { SUPERSAMPLE: samples });
        const [front] = nearest.textures, [colors, depths, normals] = surface.textures;
        gl.depthMask(true);
        gl.enable(gl.DEPTH_TEST);
        graphics.bind(nearest, clip.nothing, 0, 0, 0);
        gl.clear(gl.DEPTH_BUFFER_BIT);
        this.drawPoints("depth", layers, values, stride);
        gl.depthMask(false);
        graphics.bind(sums, 0, 0, 0, 0);
        gl.enable(gl.BLEND);
        gl.blendFunc(gl.ONE, gl.ONE);
        this.drawPoints("sum", layers, { ...values, lift: 1, front }, stride);
        gl.disable(gl.DEPTH_TEST);
        this.castShadow(day, layers, values.palette);
        const [color_sums, moment_sums, normal_sums] = sums.textures, [light] = lit.textures;
        pass(surface, "splat_resolve", { front, color_sums, moment_sums, normal_sums });
        let shown = depths;
        if (values.edge > 1) {
            pass(filtered[0], "bilateral", { depths, direction: [1, 0] });
            pass(filtered[1], "bilateral", { depths: filtered[0].textures[0], direction: [0, 1] });
            [shown] = filtered[1].textures;
        }
        pass(lit, "shade", { colors, depths: shown, normals });
        pass(this.ground, "ground", { transmittance: this.shadows[0].textures[0] });
        const screen = { framebuffer: null, width, height }, [background] = this.ground.textures;
        pass(screen, "picture", { light, background });
    }

    castShadow(day, layers, palette) {
        const { graphics, clip, gl } = this, [first, second] = this.shadows;
        const { side, points, contact_height, texel, toSquare } = clip.shadow;
        const stride = this.maxStride(day, points), { count } = clip.intervals[clip.locate(day)[0]];
        const area = 4 * clip.interpolate(clip.coverage, day) ** 2 * clip.interpolate(clip.points, day);
        graphics.bind(first, 1, 1, 1, 1);
        gl.blendFunc(gl.ZERO, gl.ONE_MINUS_SRC_COLOR);
        this.drawPoints("shadow", layers, {
            from_above: toSquare, contact_height, palette, cover: (stride * area) / count / texel ** 2,
        }, stride);
        gl.disable(gl.BLEND);
        graphics.run(second, "blur", { transmittance: first.textures[0], direction: [1 / side, 0] });
        graphics.run(first, "blur", { transmittance: second.textures[0], direction: [0, 1 / side] });
    }

    drawPoints(pass, layers, values, stride) {
        for (const { interval, group, parameter, blend, alpha } of layers) {
            const layout = this.clip.intervals[interval];
            this.graphics.use(this.programs(layout, alpha < 1)[pass], {
                ...values, box_low: layout.low, box_step: layout.step, blend, opacity: alpha,
                normal_share: parameter, weights: bernstein(layout.degree, parameter), first_point: 0,
            });
            const first = Math.ceil(group.first / stride);
            const stop = Math.ceil((group.first + group.count) / stride);
            this.bindPoints(interval, stride);
            this.gl.drawArrays(this.gl.POINTS, first, stop - first);
        }
    }

    // The programs for the passes over the points of an interval.
    programs({ degree, colored, aligned }, fading = false) {
        const program = (vertex, fragment) => this.graphics.program(vertex, fragment, {
            DEGREE: degree, SCAN_COLORS: +colored, NORMALS: +aligned, FADING: +fading,
            HAS_FLAGS: 1,
        });
        return {
            depth: program("splat", "splat_depth"), sum: program("splat", "splat_sum"),
            shadow: program("shadow", "shadow"),
        };
    }

    // The colours of organs in linear light. Newborn organs start with the colours of their parents;
    // organs beside a selected one are dimmed.
    palette(selected, day) {
        const { gl, graphics, clip } = this, [interval, share] = clip.locate(day);
        const newborn = new Map(clip.newborn[interval]);
        const key = [selected, newborn.size ? day : null].join();
        if (this.cachedPalette.key === key) return this.cachedPalette.texture;
        const { width, grey, dimmed } = clip.palette, height = Math.ceil(clip.tracks.length / width);
        const texels = new Float32Array(4 * width * height);
        clip.tracks.forEach((own, i) => {
            const from = clip.tracks[newborn.get(i) ?? i];
            const color = own.map((c, k) => (1 - share) * from[k] + share * c);
            const weight = selected < 0 || selected === i ? 1 : dimmed;
            const faded = (1 - weight) * color.reduce((sum, c, k) => sum + grey[k] * c, 0);
            texels.set([...color.map((c) => weight * c + faded), weight], 4 * i);
        });
        this.cachedPalette.texture ||= graphics.texture(width, height, gl.RGBA32F);
        this.cachedPalette.key = key;
        gl.bindTexture(gl.TEXTURE_2D, this.cachedPalette.texture);
        gl.texSubImage2D(gl.TEXTURE_2D, 0, 0, 0, width, height, gl.RGBA, gl.FLOAT, texels);
        return this.cachedPalette.texture;
    }

    // The framebuffers for a picture of a size in samples.
    targetsOf(width, height) {
        const { gl, graphics } = this;
        if (this.targets?.sums.width !== width || this.targets.sums.height !== height) {
            Object.values(this.targets || {}).flat().forEach((target) => graphics.release(target));
            const depth = gl.createRenderbuffer(), far = graphics.depthFormat;
            const target = (...formats) => graphics.target(width, height, formats, { depth });
            this.targets = {
                nearest: target(far), sums: target(gl.RGBA16F, gl.RGBA16F, gl.RG16F),
                surface: target(gl.RGBA16F, far, gl.RG16F), filtered: [target(far), target(far)],
                lit: target(gl.RGBA16F),
            };
        }
        return this.targets;
    }
}

// The Bernstein weights of a Bezier curve's control points.
function bernstein(degree, u) {
    const choose = [[1], [1, 1], [1, 2, 1], [1, 3, 3, 1]][degree];
    return choose.map((binomial, j) => binomial * u ** j * (1 - u) ** (degree - j));
}
