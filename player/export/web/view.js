// An orbit camera, which keeps the plant's up axis vertical, and the playback clock.

const clamped = (value, low, high) => Math.min(Math.max(value, low), high);

class Camera {
    // home: { target, distance, yaw, pitch, max_pitch, field_of_view, radius, aspect }, angles in radians,
    // aspect of the narrowest picture that the plant fits in; axes: two horizontal and the upward one.
    constructor(home, axes) {
        Object.assign(this, home, { home, axes });
    }

    // Show the whole plant in the upper part of a picture, a share `free` of its height.
    fit(aspect, free) {
        const farther = Math.max(this.home.aspect / aspect, 1 / free);
        Object.assign(this, this.home, { distance: this.home.distance * farther });
        this.pan(0, (1 - free) / 2 - 0.02);
    }

    // The matrix from eye coordinates (right, up, back) to local coordinates.
    pose() {
        const [first, second, upward] = this.axes, degrees = 180 / Math.PI;
        return new DOMMatrix([...first, 0, ...second, 0, ...upward, 0, ...this.target, 1])
            .rotateAxisAngle(0, 0, 1, 90 + degrees * this.yaw)
            .rotateAxisAngle(1, 0, 0, 90 - degrees * this.pitch).translate(0, 0, this.distance);
    }

    orbit(yaw, pitch) {
        this.yaw += yaw;
        this.pitch = clamped(this.pitch + pitch, -this.max_pitch, this.max_pitch);
    }

    // Shift the picture right and up by shares of its height, at the target's depth.
    pan(right, up) {
        const height = 2 * this.distance * Math.tan(this.field_of_view / 2);
        const moved = this.pose().translate(-height * right, -height * up, -this.distance);
        this.target = [moved.m41, moved.m42, moved.m43];
    }

    // Divide the distance by a factor; what is at (x, y), in picture heights from the centre, stays.
    zoom(factor, x = 0, y = 0) {
        const before = this.distance;
        this.distance = clamped(before / factor, 0.02 * this.radius, 50 * this.radius);
        const growth = before / this.distance - 1;
        this.pan(-x * growth, -y * growth);
    }

    // The matrix from eye to clip coordinates, in WebGL's column-major order.
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

// The playback clock; times are in the clip's unit.
class Clock {
    // speed: of playback in a second; pause: seconds at the end before it starts over.
    constructor(times, { speed, pause }) {
        Object.assign(this, { times, speed, pause });
        this.first = this.position = times[0];  // exceeds the last day during the pause at the end
        this.last = times.at(-1);
        this.playing = false;
    }

    get day() {
        return Math.min(this.position, this.last);
    }

    tick(seconds) {
        this.position += seconds * this.speed;
        if (this.position > this.last + this.pause * this.speed) this.position = this.first;
    }

    toggle() {
        this.playing = !this.playing;
        if (this.playing && this.day === this.last) this.position = this.first;
    }

    go(day) {
        this.position = clamped(day, this.first, this.last);
    }

    // Move by a share of the series.
    nudge(share) {
        this.playing = false;
        this.go(this.day + share * (this.last - this.first));
    }

    // Go to the next scan (1) or the previous one (-1).
    step(direction) {
        this.playing = false;
        const ahead = this.times.filter((time) => direction * (time - this.day) > 0);
        if (ahead.length) this.go(ahead.at(direction > 0 ? 0 : -1));
    }
}
