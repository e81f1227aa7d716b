// The page: connects clip, clock, camera and renderer with the controls.

// Levels of detail while the view moves: each scales width and height of the picture by 0.8, and
// halves the points as long as MIN_POINTS are left.
const LEVELS = 5, MIN_POINTS = 60000;
const SLOW = 45, FAST = 22;  // milliseconds per frame above or below which the level changes
const MAX_SUPERSAMPLED = 1.5e6;  // pixels of the largest picture with four samples per pixel
const SNAP_PX = 5;  // distance from a scan's mark within which the timeline snaps to the scan
const CONTROLS_HEIGHT = 130;  // pixels at the bottom of the page that the plant must not cover
const PLOT_HEIGHT = 70;  // additional pixels if a trait is plotted

const byId = (id) => document.getElementById(id);

function start(about, shaders) {
    const clip = new Clip(about), canvas = byId("picture");
    const renderer = new Renderer(canvas, clip, shaders);
    const clock = new Clock(clip.times, clip.clock), camera = new Camera(clip.home, clip.axes);
    const look = { ...clip.look, byTrack: clip.look.byTrack || !clip.colored, selected: -1, trait: clip.plotted[0] };
    const state = { dirty: true, moved: 0, turning: clip.look.turning, fitted: true, level: 0, trend: 0 };
    const move = () => { state.fitted = false; state.moved = performance.now(); };

    // Share of the picture's height that the controls leave to the plant.
    function freeShare() {
        const covered = CONTROLS_HEIGHT + (byId("curve").hidden ? 0 : PLOT_HEIGHT);
        return Math.max(1 - covered / canvas.clientHeight, 0.4);
    }

    function fit() {
        camera.fit(canvas.clientWidth / canvas.clientHeight, freeShare());
        state.fitted = true;
    }

    // Show or hide one of the cards, and hide the others.
    const show = (id) => ["organs", "effects", "help"].map(byId).forEach((card) => {
        card.hidden = card.id !== id || !card.hidden;
    });
    const actions = {
        play: () => clock.toggle(),
        step: (direction) => clock.step(direction),
        nudge: (share) => clock.nudge(share),
        fit,
        turn: () => { state.turning = !state.turning; },
        color: () => { look.byTrack = !clip.colored || !look.byTrack; },
        ground: () => { look.light = !look.light; },
        organs: () => show("organs"),
        effects: () => show("effects"),
        choose: (track) => { look.selected = look.selected === track ? -1 : track; },
        trait: () => {
            look.trait = clip.plotted[(clip.plotted.indexOf(look.trait) + 1) % clip.plotted.length];
        },
        go: (day) => clock.go(day),
        fullscreen: () => (document.fullscreenElement
            ? document.exitFullscreen() : document.documentElement.requestFullscreen()),
        help: () => show("help"),
        leave: () => show(),
    };
    const act = (name, value) => {
        actions[name](value);
        refresh();
        state.dirty = true;
    };

    function refresh() {
        document.documentElement.dataset.ground = look.light ? "light" : "dark";
        document.body.classList.toggle("playing", clock.playing);
        document.querySelector('[data-do="turn"]').classList.toggle("on", state.turning);
        document.querySelector('[data-do="color"]').classList.toggle("on", look.byTrack);
        byId("scale")?.toggleAttribute("hidden", look.byTrack);
        document.querySelectorAll("#organs button").forEach((button) =>
            button.classList.toggle("on", Number(button.dataset.track) === look.selected));
        plot();
    }

    // Plot a trait or mean field of the selected organ above the timeline, on the same time axis.
    function plot() {
        const [label, curve] = clip.curves[`${look.selected} ${look.trait}`] || [];
        const before = freeShare();
        byId("curve").hidden = !curve;
        camera.zoom(freeShare() / before, 0, 0.5);
        if (!curve) return;
        const [figure, , caption] = byId("curve").children;
        figure.innerHTML = curve;
        caption.textContent = label;
    }

    // Show the current day as text and on the timeline.
    function showDay() {
        const [date, elapsed] = clip.dateOf(clock.day);
        byId("time").value = clock.day;
        byId("time").setAttribute("aria-valuetext", date);
        byId("date").textContent = date;
        byId("curve").children[1].style.left =
            `${(100 * (clock.day - clock.first)) / (clock.last - clock.first)}%`;
        byId("elapsed").textContent = elapsed;
    }

    // Draw at a level of detail; at rest with four samples per pixel if the machine is fast enough.
    function draw(level, atRest = true) {
        const scale = 0.8 ** level * Math.min(window.devicePixelRatio || 1, 2);
        const [width, height] = [canvas.clientWidth, canvas.clientHeight].map(
            (length) => Math.max(Math.round(length * scale), 1));
        if (canvas.width !== width || canvas.height !== height) Object.assign(canvas, { width, height });
        const supersample = atRest && state.level === 0 && width * height < MAX_SUPERSAMPLED ? 2 : 1;
        const stride = Math.min(2 ** level, renderer.maxStride(clock.day, MIN_POINTS));
        renderer.draw(clock.day, camera, look, { stride, supersample });
        state.dirty = false;
    }

    // Adapt the level of detail to the duration of a frame while the view moves.
    function adapt(milliseconds) {
        state.trend += milliseconds > SLOW ? 1 : milliseconds < FAST ? -0.2 : 0;
        if (Math.abs(state.trend - 1) < 1.5) return;
        const steps = state.trend > 0 ? Math.max(Math.round(Math.log2(milliseconds / SLOW)), 1) : -1;
        state.level = clamped(state.level + steps, 0, LEVELS - 1);
        state.trend = 0;
    }

    let before = performance.now(), wasMoving = false;
    function frame(now) {
        requestAnimationFrame(frame);
        const passed = Math.min(now - before, 250), [needed] = clip.locate(clock.day);
        before = now;
        byId("waiting").hidden = renderer.isReady(needed);
        if (!renderer.isReady(needed)) return;
        for (const near of [needed + 1, needed - 1]) if (clip.intervals[near]) renderer.isReady(near);
        const moving = clock.playing || state.turning || now - state.moved < 200;
        if (state.turning) camera.orbit((0.35 * passed) / 1000, 0);
        if (moving && wasMoving) adapt(passed);
        if (moving || state.dirty || wasMoving) {
            draw(moving ? state.level : 0, !moving);
            showDay();
        }
        wasMoving = moving;
        if (clock.playing) clock.tick(passed / 1000);
    }

    byId("time").addEventListener("input", ({ target: time }) => {
        const tolerance = (SNAP_PX * (clock.last - clock.first)) / time.clientWidth;
        act("go", clip.times.find((scan) => Math.abs(scan - time.value) < tolerance) ?? Number(time.value));
    });
    byId("effects").addEventListener("input", ({ target: { name, type, checked, valueAsNumber } }) => {
        clip.uniforms[name] = type === "checkbox" ? Number(checked) : valueAsNumber;
        state.dirty = true;
    });
    listen(canvas, camera, act, move);
    new ResizeObserver(() => act(state.fitted ? "fit" : "go", clock.day)).observe(canvas);
    canvas.addEventListener("webglcontextlost", () => location.reload());
    clock.playing = !window.matchMedia("(prefers-reduced-motion: reduce)").matches;
    act("fit");
    requestAnimationFrame(frame);

    // For tests and for scripts in the browser's console.
    window.viewer = {
        clip, clock, camera, look, act, renderer, state,
        async seek(day) {
            clock.playing = false;
            clock.go(day);
            const [index] = clip.locate(day);
            for (const k of [index, index - 1]) while (k >= 0 && !renderer.isReady(k)) await nextTask();
            act("leave");
            draw(0);
            showDay();
        },
    };
}

const KEYS = {
    " ": ["play"], f: ["fit"], t: ["turn"], c: ["color"], g: ["ground"], o: ["organs"], e: ["effects"],
    l: ["trait"], h: ["help"], "?": ["help"], Escape: ["leave"], Home: ["go", -Infinity], End: ["go", Infinity],
    ArrowLeft: ["nudge", -0.01], ArrowRight: ["nudge", 0.01], PageUp: ["step", -1], PageDown: ["step", 1],
};

// Register input events. One pointer turns the plant; Shift, other buttons or two fingers shift it.
function listen(canvas, camera, act, move) {
    const pointers = new Map();  // positions of pressed pointers, in picture heights from the centre
    const position = ({ clientX, clientY }) => [
        (clientX - canvas.clientWidth / 2) / canvas.clientHeight, 0.5 - clientY / canvas.clientHeight];
    const gesture = () => {  // midpoint and distance of the first two pointers
        const [[x, y], [u, v] = [x, y]] = pointers.values();
        return [(x + u) / 2, (y + v) / 2, Math.hypot(x - u, y - v)];
    };
    canvas.addEventListener("pointerdown", (event) => {
        canvas.setPointerCapture(event.pointerId);
        pointers.set(event.pointerId, position(event));
        canvas.focus({ preventScroll: true });
    });
    canvas.addEventListener("pointermove", (event) => {
        if (!pointers.has(event.pointerId)) return;
        const [u, v, oldDistance] = gesture();
        pointers.set(event.pointerId, position(event));
        const [x, y, distance] = gesture();
        if (pointers.size > 1 || event.shiftKey || event.buttons & 6) camera.pan(x - u, y - v);
        else camera.orbit(Math.PI * (u - x), Math.PI * (v - y));
        if (oldDistance > 0 && distance > 0) camera.zoom(distance / oldDistance, x, y);
        move();
    });
    canvas.addEventListener("lostpointercapture", (event) => pointers.delete(event.pointerId));
    canvas.addEventListener("contextmenu", (event) => event.preventDefault());
    canvas.addEventListener("dblclick", () => act("fit"));
    canvas.addEventListener("wheel", (event) => {
        event.preventDefault();
        const notches = clamped(event.deltaY / (event.deltaMode === 1 ? 3 : 100), -5, 5);
        camera.zoom(1.12 ** -notches, ...position(event));
        move();
    }, { passive: false });
    document.addEventListener("keydown", (event) => {
        if (event.ctrlKey || event.metaKey || event.altKey) return;
        const page = event.shiftKey && { ArrowLeft: "PageUp", ArrowRight: "PageDown" }[event.key];
        const action = KEYS[page || event.key] || KEYS[event.key.toLowerCase()];
        if (!action || (event.key === " " && event.target.tagName === "BUTTON")) return;
        if (action[0] !== "leave" && event.target.closest("#effects")) return;
        event.preventDefault();
        act(...action);
    });
    document.querySelectorAll("[data-do]").forEach((button) =>
        button.addEventListener("click", () => act(button.dataset.do, Number(button.dataset.track))));
}

function showError(error) {
    byId("waiting").hidden = true;
    byId("trouble").hidden = false;
    byId("trouble").textContent = error.message || String(error);
}

window.addEventListener("error", (event) => showError(event.error));
window.addEventListener("unhandledrejection", (event) => showError(event.reason));
if (typeof DecompressionStream === "undefined") {
    throw new Error("This browser is too old to unpack the plant; one from 2023 or later can.");
}
// Show the page first, because the graphics driver may take a while to start.
requestAnimationFrame(() => setTimeout(() =>
    start(...["clip", "shaders"].map((id) => JSON.parse(byId(id).textContent)))));
