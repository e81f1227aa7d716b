// The camera: turns about a target, with the plant's own up axis kept upright.

const STEEPEST = (89 * Math.PI) / 180;
const MARGIN = 0.84;  // share of the free picture that a fitted plant fills

const dot = (a, b) => a[0] * b[0] + a[1] * b[1] + a[2] * b[2];
const cross = (a, b) => [
    a[1] * b[2] - a[2] * b[1], a[2] * b[0] - a[0] * b[2], a[0] * b[1] - a[1] * b[0],
];
const scaled = (a, s) => [s * a[0], s * a[1], s * a[2]];
const sum = (...vectors) => [0, 1, 2].map((i) => vectors.reduce((t, v) => t + v[i], 0));

// Two horizontal axes and the up axis, right-handed.
function axesOf(up) {
    const index = "xyz".indexOf(up[up.length - 1]), sign = up[0] === "-" ? -1 : 1;
    const unit = (i, s) => [0, 1, 2].map((j) => (j === i % 3 ? s : 0));
    return [unit(index + 1, 1), unit(index + 2, sign), unit(index, sign)];
}

class Camera {
    // view: { target, distance, yaw, pitch, fieldOfView }, angles in radians.
    constructor(view, up, radius) {
        Object.assign(this, view);
        this.axes = axesOf(up);
        this.radius = radius;
    }

    // Rows: right, above, and from the target to the eye.
    frame() {
        const [first, second, upward] = this.axes;
        const outward = sum(
            scaled(first, Math.cos(this.yaw)), scaled(second, Math.sin(this.yaw)));
        const backward = sum(
            scaled(outward, Math.cos(this.pitch)), scaled(upward, Math.sin(this.pitch)));
        const right = cross(upward, outward);
        return [right, cross(backward, right), backward];
    }

    orbit(yaw, pitch) {
        this.yaw += yaw;
        this.pitch = Math.min(Math.max(this.pitch + pitch, -STEEPEST), STEEPEST);
    }

    // Shift the picture right and up by shares of its height, at the target's depth.
    pan(right, up) {
        const height = 2 * this.distance * Math.tan(this.fieldOfView / 2);
        const [across, above] = this.frame();
        this.target = sum(
            this.target, scaled(across, -height * right), scaled(above, -height * up));
    }

    // Come nearer by a factor above 1; the place at (x, y), in picture heights from the middle,
    // stays where it is.
    zoom(factor, x = 0, y = 0) {
        const before = this.distance;
        const wanted = before / factor;
        this.distance = Math.min(Math.max(wanted, 0.02 * this.radius), 50 * this.radius);
        const kept = before / this.distance - 1;
        this.pan(-x * kept, -y * kept);
    }

    // As near as the picture allows with all `points` in it, and centred.
    // free: share of the picture's height, from its top, that nothing covers.
    fit(points, aspect, free) {
        const slope = Math.tan(this.fieldOfView / 2) * MARGIN;
        for (let round = 0; round < 5; ++round) {
            const rows = this.frame();
            const seen = points.map((p) => rows.map((row) => dot(row, p) - dot(row, this.target)));
            const limits = [Infinity, -Infinity, Infinity, -Infinity];
            for (const [right, above, towards] of seen) {
                const away = this.distance - towards;
                limits[0] = Math.min(limits[0], right / away);
                limits[1] = Math.max(limits[1], right / away);
                limits[2] = Math.min(limits[2], above / away);
                limits[3] = Math.max(limits[3], above / away);
            }
            this.target = sum(
                this.target,
                scaled(rows[0], (this.distance * (limits[0] + limits[1])) / 2),
                scaled(rows[1], (this.distance * (limits[2] + limits[3])) / 2));
            this.distance = Math.max(...points.map((p) => {
                const offset = sum(p, scaled(this.target, -1));
                const [right, above, towards] = rows.map((row) => dot(row, offset));
                const needed = Math.max(Math.abs(right) / aspect, Math.abs(above) / free) / slope;
                return towards + needed;
            }));
        }
        this.pan(0, (1 - free) / 2 - 0.02);
    }

    // Column-major matrices, as WebGL takes them.
    view() {
        const [r, a, b] = this.frame();
        const eye = sum(this.target, scaled(b, this.distance));
        return [
            r[0], a[0], b[0], 0, r[1], a[1], b[1], 0, r[2], a[2], b[2], 0,
            -dot(r, eye), -dot(a, eye), -dot(b, eye), 1,
        ];
    }

    projection(aspect) {
        const near = Math.max(this.distance - 4 * this.radius, 0.02 * this.distance);
        const far = this.distance + 4 * this.radius;
        const slope = Math.tan(this.fieldOfView / 2);
        return [
            1 / (slope * aspect), 0, 0, 0, 0, 1 / slope, 0, 0,
            0, 0, (near + far) / (near - far), -1, 0, 0, (2 * near * far) / (near - far), 0,
        ];
    }
}
