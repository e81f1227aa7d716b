// The clip: which movers are visible at a time (docs/format.md), and decompression of their data.

const PIECE = 1 << 19;  // characters decoded at once, a multiple of 4

class Clip {
    constructor(about) {
        Object.assign(this, about);
    }

    // The index of the interval at a time, and the share of it that has passed, from 0 to 1.
    locate(day) {
        const index = Math.max(this.intervals.findLastIndex(({ start }) => start <= day), 0);
        const { start, end } = this.intervals[index];
        return [index, Math.min(Math.max((day - start) / (end - start), 0), 1)];
    }

    // The visible layers at a time: groups of movers, the parameter on their curves, the weight of their
    // end colours (blend), and their opacity (alpha).
    layersAt(day) {
        const [interval, share] = this.locate(day);
        const opacity = { move: 1, fall: 1, fade: 1 - share, remove: share === 0 ? 1 : 0 };
        const layers = this.intervals[interval].groups.map((group) => ({
            interval, group, alpha: opacity[group.motion], blend: share,
            parameter: group.motion === "fall" ? share * share : share,
        }));
        const litter = (this.intervals[interval - 1]?.groups || []).map((group) => ({
            interval: interval - 1, group, blend: 1, parameter: 1,
            alpha: group.motion === "fall" ? 1 - share / this.litterFade : 0,
        }));
        return [...layers, ...litter].filter(({ alpha }) => alpha > 0);
    }

    // Interpolate values at the scans linearly.
    interpolate(values, day) {
        const [index, share] = this.locate(day);
        return (1 - share) * values[index] + share * values[index + 1];
    }

    // The date of a time and the time since the first scan, as text.
    dateOf(day) {
        return this.moments.findLast(([time]) => time <= day).slice(1);
    }

    // Decode the data of an interval: points (start, controls..., end), tracks, colors and normals.
    // It is decoded in pieces, so that the page stays responsive.
    async load(index) {
        const text = document.getElementById(`interval-${index}`).textContent.trim(), parts = [];
        for (let start = 0; start < text.length; start += PIECE) {
            const piece = atob(text.slice(start, start + PIECE)), bytes = new Uint8Array(piece.length);
            for (let i = 0; i < piece.length; ++i) bytes[i] = piece.charCodeAt(i);
            parts.push(bytes);
            await nextTask();
        }
        const stream = new Blob(parts).stream().pipeThrough(new DecompressionStream("deflate"));
        const bytes = new Uint8Array(await new Response(stream).arrayBuffer());
        return decode(bytes, this.intervals[index]);
    }
}

// Lets the browser handle pending events.
const nextTask = () => new Promise((done) => setTimeout(done));

// Inverse of encode.py: byte planes contain zigzag-coded differences to the previous mover, and the
// columns of a sequence, such as control points, are differences to the previous column.
async function decode(bytes, { count, degree, track_bytes, colored, aligned }) {
    let position = 0;
    async function sequence(Numbers, components, length) {
        const width = Numbers.BYTES_PER_ELEMENT, columns = [];
        while (columns.length < length) {
            const values = new Numbers(columns.at(-1) || components * count);
            for (let component = 0; component < components; ++component) {
                for (let i = 0, sum = 0; i < count; ++i) {
                    let zigzag = 0;
                    for (let byte = 0; byte < width; ++byte) {
                        zigzag |= bytes[position + byte * count + i] << (8 * byte);
                    }
                    values[components * i + component] += sum += (zigzag >>> 1) ^ -(zigzag & 1);
                }
                position += width * count;
                await nextTask();
            }
            columns.push(values);
        }
        return columns;
    }
    return {
        points: await sequence(Uint16Array, 3, degree + 1),
        tracks: await sequence(track_bytes === 2 ? Uint16Array : Uint32Array, 1, 1),
        colors: await sequence(Uint8Array, 3, colored ? 2 : 0),
        normals: await sequence(Uint8Array, 4, aligned ? 1 : 0),
    };
}
