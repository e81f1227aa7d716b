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
    async load(index) {
        const text = document.getElementById(`interval-${index}`).textContent;
        return unpack(await inflated(bytesOf(text.trim())), this.intervals[index]);
    }
}

// The Bernstein weights of a Bezier curve's points.
function bernstein(degree, u) {
    const v = 1 - u;
    if (degree === 1) return [v, u];
    if (degree === 2) return [v * v, 2 * u * v, u * u];
    return [v * v * v, 3 * u * v * v, 3 * u * u * v, u * u * u];
}

function bytesOf(base64) {
    const text = atob(base64), bytes = new Uint8Array(text.length);
    for (let i = 0; i < text.length; ++i) bytes[i] = text.charCodeAt(i);
    return bytes;
}

async function inflated(bytes) {
    const stream = new Blob([bytes]).stream().pipeThrough(new DecompressionStream("deflate"));
    return new Uint8Array(await new Response(stream).arrayBuffer());
}

// Undo what packing.py did: byte planes of differences between neighbouring movers.
function unpack(bytes, { count, degree, trackBytes, colored }) {
    let at = 0;
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
    const positions = (foretold) => {
        const points = new Uint16Array(3 * count);
        for (let offset = 0; offset < 3; ++offset) axis(points, offset, foretold);
        return points;
    };
    const start = positions(null);
    const end = positions((i) => start[i]);
    const curve = [start];
    for (let j = 1; j < degree; ++j) {
        curve.push(positions((i) => Math.floor((start[i] * (degree - j) + end[i] * j) / degree)));
    }
    curve.push(end);

    const tracks = trackBytes === 2 ? new Uint16Array(count) : new Uint32Array(count);
    for (let shift = 0; shift < 8 * trackBytes; shift += 8) {
        const part = plane();
        for (let i = 0; i < count; ++i) tracks[i] |= part[i] << shift;
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
        }
        colors.push(paint);
    }
    return { points: curve, tracks, colors };
}
