// The clock over the series, and what to call a moment.

const SPEEDS = [0.125, 0.25, 0.5, 1, 2, 4, 8];
const REST = 0.8;  // seconds to look at an end before the clock goes on

class Clock {
    constructor(times) {
        this.times = times;
        this.first = this.day = times[0];
        this.last = times[times.length - 1];
        this.playing = false;
        this.speed = 1;
        this.rest = 0;
    }

    get daysPerSecond() {
        const seconds = Math.min(Math.max(2 * (this.times.length - 1), 4), 24);
        return (this.speed * (this.last - this.first)) / seconds;
    }

    tick(seconds) {
        if (!this.playing) return;
        if (this.rest > 0) {
            this.rest -= seconds;
            if (this.rest <= 0) this.day = this.first;
            return;
        }
        this.day = Math.min(this.day + seconds * this.daysPerSecond, this.last);
        if (this.day === this.last) this.rest = REST;
    }

    toggle() {
        this.playing = !this.playing;
        if (this.playing && this.day === this.last) this.day = this.first;
        this.rest = 0;
    }

    go(day) {
        this.day = Math.min(Math.max(day, this.first), this.last);
        this.rest = 0;
    }

    nudge(share) {
        this.playing = false;
        this.go(this.day + share * (this.last - this.first));
    }

    // To the next scan (1) or the one before (-1).
    step(direction) {
        this.playing = false;
        const ahead = this.times.filter((time) => direction * (time - this.day) > 0);
        if (ahead.length) this.go(direction > 0 ? ahead[0] : ahead[ahead.length - 1]);
    }

    hasten(direction) {
        const at = SPEEDS.indexOf(this.speed) + direction;
        this.speed = SPEEDS[Math.min(Math.max(at, 0), SPEEDS.length - 1)];
    }
}

// The date of a moment, written in the way of the scans before and after it.
function dateAt({ times, dates }, day) {
    let index = 0;
    while (index + 1 < times.length && times[index + 1] <= day) index += 1;
    if (day <= times[index] || index + 1 === times.length) return dates[index];
    const share = (day - times[index]) / (times[index + 1] - times[index]);
    const [before, after] = [dates[index], dates[index + 1]];
    return moment(before, after, share) || numbered(before, after, share) || day.toFixed(1);
}

function moment(before, after, share) {
    const iso = /^\d{4}-\d\d-\d\d([T ]\d\d:\d\d.*)?$/;
    if (!iso.test(before) || !iso.test(after)) return "";
    const [start, end] = [before, after].map((date) => Date.parse(
        /[T ]/.test(date) ? `${date.replace(" ", "T").replace(/(Z|[+-]\d\d:?\d\d)$/, "")}Z` : date));
    if (Number.isNaN(start) || Number.isNaN(end)) return "";
    const text = new Date(start + share * (end - start)).toISOString();
    return (before + after).includes(":") ? text.slice(0, 16).replace("T", " ") : text.slice(0, 10);
}

function numbered(before, after, share) {
    const pattern = /^([^]*?)(-?\d+(?:\.\d+)?)$/;
    const [start, end] = [before.match(pattern), after.match(pattern)];
    if (!start || !end || start[1] !== end[1]) return "";
    return start[1] + ((1 - share) * Number(start[2]) + share * Number(end[2])).toFixed(1);
}

// The time since the first scan.
function elapsed({ times, timeUnit }, day) {
    const passed = day - times[0];
    return timeUnit === "days" ? `+${passed.toFixed(1)} days` : `scan ${(1 + passed).toFixed(1)}`;
}
