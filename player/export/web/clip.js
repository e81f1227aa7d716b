// The clip: what is visible when (the same rules as docs/format.md), and its movers' numbers.

const LITTER_FADE = 0.15;  // share of the following interval during which fallen organs fade
const PIECE = 1 << 19;  // characters unpacked in one go, in fours

class Clip {
    constructor(about) {
        Object.assign(this, about);
    }

    // The interval that a time falls into and the share of it that has passed, 0 to 1.
    locate(day) {
        const index = Math.max(this.intervals.findLastIndex(({ start }) => start <= day), 0);
        const { start, end } = this.intervals[index];
        return [index, Math.min(Math.max((day - start) / (end - start), 0), 1)];
    }

    // What is visible at a time: runs of points, where on their paths they are, the share of the
    // end's colour that they have, and their opacity.
    layersAt(day) {
        const [interval, share] = this.locate(day);
        const opacity = { move: 1, fall: 1, fade: 1 - share, remove: share === 0 ? 1 : 0 };
        const layers = this.intervals[interval].groups.map((group) => ({
            interval, group, alpha: opacity[group.motion], blend: share,
            parameter: group.motion === "fall" ? share * share : share,
        }));
        const litter = (this.intervals[interval - 1]?.groups || []).map((group) => ({
            interval: interval - 1, group, blend: 1, parameter: 1,
            alpha: group.motion === "fall" ? 1 - share / LITTER_FADE : 0,
        }));
        return [...layers, ...litter].filter(({ alpha }) => alpha > 0);
    }

    // A number that stands at each scan, in between.
    between(values, day) {
        const [index, share] = this.locate(day);
        return (1 - share) * values[index] + share * values[index + 1];
    }

    // What a moment is called, and the time since the first scan.
    namesOf(day) {
        return this.moments.findLast(([time]) => time <= day).slice(1);
    }

    // The columns of one interval: points (start, controls..., end), tracks, colors and normals.
    // Unpacked piece by piece, so that the page answers meanwhile.
    async load(index) {
        const text = document.getElementById(`interval-${index}`).textContent.trim(), parts = [];
        for (let at = 0; at < text.length; at += PIECE) {
            const piece = atob(text.slice(at, at + PIECE)), bytes = new Uint8Array(piece.length);
            for (let i = 0; i < piece.length; ++i) bytes[i] = piece.charCodeAt(i);
            parts.push(bytes);
            await nextTurn();
        }
        const stream = new Blob(parts).stream().pipeThrough(new DecompressionStream("deflate"));
        const bytes = new Uint8Array(await new Response(stream).arrayBuffer());
        return unpack(bytes, this.intervals[index]);
    }
}

// Lets the page answer what has happened meanwhile.
const nextTurn = () => new Promise((done) => setTimeout(done));

// Undo what encode.py did: each number is the difference to the mover before it, byte by byte, with
// its sign in the lowest bit; and each column of a sequence, the difference to the one before.
async function unpack(bytes, { count, degree, track_bytes, colored, aligned }) {
    let at = 0;
    async function sequence(Numbers, sides, length) {
        const width = Numbers.BYTES_PER_ELEMENT, columns = [];
        while (columns.length < length) {
            const values = new Numbers(columns.at(-1) || sides * count);
            for (let side = 0; side < sides; ++side) {
                for (let i = 0, sum = 0; i < count; ++i) {
                    let zigzag = 0;
                    for (let byte = 0; byte < width; ++byte) {
                        zigzag |= bytes[at + byte * count + i] << (8 * byte);
                    }
                    values[sides * i + side] += sum += (zigzag >>> 1) ^ -(zigzag & 1);
                }
                at += width * count;
                await nextTurn();
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
