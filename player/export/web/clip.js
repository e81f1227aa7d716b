// The clip: what is visible when (the same rules as docs/format.md), and its movers' numbers.

const LITTER_FADE = 0.15;  // share of the following interval during which fallen organs fade

class Clip {
    constructor(about) {
        Object.assign(this, about);
        this.first = this.times[0];
        this.last = this.times[this.times.length - 1];
    }

    // The interval that a time falls into and the share of it that has passed, 0 to 1.
    locate(day) {
        let index = 0;
        while (index + 1 < this.intervals.length && this.intervals[index + 1].start <= day) {
            index += 1;
        }
        const { start, end } = this.intervals[index];
        return [index, Math.min(Math.max((day - start) / (end - start), 0), 1)];
    }

    // What is visible at a time, the plant first, then the litter.
    layersAt(day) {
        const [interval, share] = this.locate(day);
        const plant = [], litter = [];
        const layer = (parameter, blend, alpha) => ({ parameter, blend, alpha });
        for (const group of this.intervals[interval].groups) {
            const put = (to, look) => to.push({ interval, group, ...look });
            if (group.motion === "move" || share === 0) {
                put(plant, layer(share, share, 1));
            } else if (group.motion === "fall" && share < 1) {
                put(plant, layer(share * share, share, 1));
            } else if (group.motion === "fall") {
                put(litter, layer(1, 1, 1));
            } else if (group.motion === "fade" && share < 1) {
                put(plant, layer(share, share, 1 - share));
            }
        }
        if (interval > 0 && share < LITTER_FADE) {
            for (const group of this.intervals[interval - 1].groups) {
                if (group.motion === "fall") {
                    const look = layer(1, 1, 1 - share / LITTER_FADE);
                    litter.push({ interval: interval - 1, group, ...look });
                }
            }
        }
        return plant.concat(litter);
    }

    // Radius within which discs on the points close the surface they lie on.
    closingAt(day) {
        const [index, share] = this.locate(day);
        return (1 - share) * this.closing[index] + share * this.closing[index + 1];
    }

    // Points of the scans' surface that one mover stands for, 0 to 1.
    pointsAMover(day) {
        const [index, share] = this.locate(day);
        const points = (1 - share) * this.points[index] + share * this.points[index + 1];
        return points / Math.max(this.intervals[index].count, 1);
    }

    // The buffers of one interval: { points: [start, controls..., end], tracks, colors }.
    // told: called with the share that is done.
    load(index, told) {
        const text = document.getElementById(`interval-${index}`).textContent;
        this.unpacker ||= new Unpacker();
        return this.unpacker.unpack(text, this.intervals[index], told);
    }
}

// Unpacks in a thread of its own, so that the page answers; where there is none, piece by piece.
class Unpacker {
    constructor() {
        this.asked = new Map();
        this.last = 0;
        try {
            const parts = [PIECE, bytesOf, inflated, unpack, unpacked, answer].map(
                (part) => (typeof part === "function" ? String(part) : `const PIECE = ${part};`));
            const text = [...parts, "onmessage = answer;"].join("\n");
            const url = URL.createObjectURL(new Blob([text], { type: "text/javascript" }));
            this.worker = new Worker(url);
            this.worker.onmessage = ({ data }) => this.hear(data);
            this.worker.onerror = (event) => { event.preventDefault(); this.doWithout(); };
        } catch {
            this.worker = null;
        }
    }

    unpack(text, about, told) {
        if (!this.worker) return unpacked(text, about, told, nextTurn);
        const number = ++this.last;
        return new Promise((done, failed) => {
            this.asked.set(number, { done, failed, text, about, told });
            this.worker.postMessage({ number, text, about });
        });
    }

    hear({ number, share, data, trouble }) {
        const asked = this.asked.get(number);
        if (share !== undefined) {
            asked.told(share);
            return;
        }
        this.asked.delete(number);
        if (data) asked.done(data);
        else asked.failed(new Error(trouble));
    }

    // Some browsers start no worker from a page on the disk.
    doWithout() {
        this.worker = null;
        for (const { done, failed, text, about, told } of this.asked.values()) {
            unpacked(text, about, told, nextTurn).then(done, failed);
        }
        this.asked.clear();
    }
}

// What the worker does with a message.
async function answer({ data: { number, text, about } }) {
    try {
        const told = (share) => postMessage({ number, share });
        const data = await unpacked(text, about, told, () => null);
        const buffers = [...data.points, data.tracks, ...data.colors].map(({ buffer }) => buffer);
        postMessage({ number, data }, buffers);
    } catch (error) {
        postMessage({ number, trouble: error.message });
    }
}

// rest: what is waited for between pieces.
async function unpacked(text, about, told, rest) {
    let bytes, data;
    for (const found of bytesOf(text.trim())) {
        bytes = found;
        await rest();
    }
    bytes = await inflated(bytes);
    for (const [share, found] of unpack(bytes, about)) {
        data = found;
        told(share);
        await rest();
    }
    return data;
}

// Lets the page answer what has happened meanwhile.
function nextTurn() {
    return new Promise((done) => setTimeout(done));
}

// The Bernstein weights of a Bezier curve's points.
function bernstein(degree, u) {
    const v = 1 - u;
    if (degree === 1) return [v, u];
    if (degree === 2) return [v * v, 2 * u * v, u * u];
    return [v * v * v, 3 * u * v * v, 3 * u * u * v, u * u * u];
}

const PIECE = 1 << 19;  // characters, in fours

// Piece by piece; the bytes are whole at the last one.
function* bytesOf(base64) {
    const padding = base64.endsWith("==") ? 2 : base64.endsWith("=") ? 1 : 0;
    const bytes = new Uint8Array((base64.length / 4) * 3 - padding);
    for (let at = 0, put = 0; at < base64.length; at += PIECE) {
        const text = atob(base64.slice(at, at + PIECE));
        for (let i = 0; i < text.length; ++i) bytes[put++] = text.charCodeAt(i);
        yield bytes;
    }
}

async function inflated(bytes) {
    const stream = new Blob([bytes]).stream().pipeThrough(new DecompressionStream("deflate"));
    return new Uint8Array(await new Response(stream).arrayBuffer());
}

// Undo what packing.py did: byte planes of differences between neighbouring movers. Piece by piece,
// with the share that is done; the buffers are whole at the last one.
function* unpack(bytes, { count, degree, trackBytes, colored }) {
    let at = 0;
    const done = (data) => [at / Math.max(bytes.length, 1), data];
    const plane = () => bytes.subarray(at, (at += count));

    // One axis: differences, zigzag, low bytes then high bytes; added to what was foretold.
    const axis = (points, offset, foretold) => {
        const low = plane(), high = plane();
        let sum = 0;
        for (let i = 0; i < count; ++i) {
            const zigzag = low[i] | (high[i] << 8);
            sum += (zigzag >> 1) ^ -(zigzag & 1);
            points[3 * i + offset] = sum + (foretold ? foretold(3 * i + offset) : 0);
        }
    };
    function* positions(foretold) {
        const points = new Uint16Array(3 * count);
        for (let offset = 0; offset < 3; ++offset) {
            axis(points, offset, foretold);
            yield done();
        }
        return points;
    }
    const start = yield* positions(null);
    const end = yield* positions((i) => start[i]);
    const curve = [start];
    for (let j = 1; j < degree; ++j) {
        curve.push(yield* positions(
            (i) => Math.floor((start[i] * (degree - j) + end[i] * j) / degree)));
    }
    curve.push(end);

    const tracks = trackBytes === 2 ? new Uint16Array(count) : new Uint32Array(count);
    for (let shift = 0; shift < 8 * trackBytes; shift += 8) {
        const part = plane();
        for (let i = 0; i < count; ++i) tracks[i] |= part[i] << shift;
        yield done();
    }
    const colors = [];
    for (let end = 0; colored && end < 2; ++end) {
        const paint = new Uint8Array(3 * count);
        for (let offset = 0; offset < 3; ++offset) {
            const part = plane();
            let sum = 0;
            for (let i = 0; i < count; ++i) {
                sum += part[i];
                paint[3 * i + offset] = sum + (end ? colors[0][3 * i + offset] : 0);
            }
            yield done();
        }
        colors.push(paint);
    }
    yield done({ points: curve, tracks, colors });
}
