// The camera, which turns about a target with the plant's own up axis upright, and the clock.

const STEEPEST = (89 * Math.PI) / 180;
const REST = 0.8;  // seconds to look at an end before the clock goes on

const clamped = (value, low, high) => Math.min(Math.max(value, low), high);

class Camera {
    // home: { target, distance, yaw, pitch, field_of_view, radius, aspect }, angles in radians, aspect
    // of the narrowest picture that the plant fits in; axes: two horizontal ones and the upward one.
    constructor(home, axes) {
        Object.assign(this, home, { home, axes });
    }

    // The whole plant in a picture of this shape, of whose height a share is free, from the top.
    fit(aspect, free) {
        const farther = Math.max(this.home.aspect / aspect, 1 / free);
        Object.assign(this, this.home, { distance: this.home.distance * farther });
        this.pan(0, (1 - free) / 2 - 0.02);
    }

    // From the eye's coordinates, right, above and backwards, to local ones.
    pose() {
        const [first, second, upward] = this.axes, turn = 180 / Math.PI;
        return new DOMMatrix([...first, 0, ...second, 0, ...upward, 0, ...this.target, 1])
            .rotateAxisAngle(0, 0, 1, 90 + turn * this.yaw)
            .rotateAxisAngle(1, 0, 0, 90 - turn * this.pitch).translate(0, 0, this.distance);
    }

    orbit(yaw, pitch) {
        this.yaw += yaw;
        this.pitch = clamped(this.pitch + pitch, -STEEPEST, STEEPEST);
    }

    // Shift the picture right and up by shares of its height, at the target's depth.
    pan(right, up) {
        const height = 2 * this.distance * Math.tan(this.field_of_view / 2);
        const moved = this.pose().translate(-height * right, -height * up, -this.distance);
        this.target = [moved.m41, moved.m42, moved.m43];
    }

    // Come nearer by a factor above 1; the place at (x, y), in picture heights from the middle,
    // stays where it is.
    zoom(factor, x = 0, y = 0) {
        const before = this.distance;
        this.distance = clamped(before / factor, 0.02 * this.radius, 50 * this.radius);
        const kept = before / this.distance - 1;
        this.pan(-x * kept, -y * kept);
    }

    // From the eye's coordinates to the picture; column-major, as WebGL takes it.
    projection(aspect) {
        const near = Math.max(this.distance - 4 * this.radius, 0.02 * this.distance);
        const far = this.distance + 4 * this.radius;
        const slope = Math.tan(this.field_of_view / 2);
        return [
            1 / (slope * aspect), 0, 0, 0, 0, 1 / slope, 0, 0,
            0, 0, (near + far) / (near - far), -1, 0, 0, (2 * near * far) / (near - far), 0,
        ];
    }
}

class Clock {
    constructor(times) {
        this.times = times;
        this.first = this.position = times[0];  // goes on beyond the last day for a while
        this.last = times.at(-1);
        this.playing = false;
    }

    get day() {
        return Math.min(this.position, this.last);
    }

    tick(seconds) {
        const whole = clamped(2 * (this.times.length - 1), 4, 24);  // seconds
        const pace = (this.last - this.first) / whole;
        this.position += seconds * pace;
        if (this.position > this.last + REST * pace) this.position = this.first;
    }

    toggle() {
        this.playing = !this.playing;
        if (this.playing && this.day === this.last) this.position = this.first;
    }

    go(day) {
        this.position = clamped(day, this.first, this.last);
    }

    nudge(share) {
        this.playing = false;
        this.go(this.day + share * (this.last - this.first));
    }

    // To the next scan (1) or the one before (-1).
    step(direction) {
        this.playing = false;
        const ahead = this.times.filter((time) => direction * (time - this.day) > 0);
        if (ahead.length) this.go(ahead.at(direction > 0 ? 0 : -1));
    }
}
