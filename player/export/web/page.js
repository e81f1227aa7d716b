// The page: puts clip, clock, camera and renderer together and lets people touch them.

// While things move, at each level 0.8 times the picture's width and height, and half of the points
// as long as FEWEST are left.
const LEVELS = 5, FEWEST = 60000;
const SLOW = 45, FAST = 22;  // milliseconds a picture at which less, or more, is drawn
const SUPERSAMPLED = 1.5e6;  // pixels up to which each has four samples at rest
const SNAP = 5;  // pixels about a scan's mark within which the timeline goes to the scan
const COVERED = 130;  // pixels of the page's foot, that the plant is kept clear of
const PLOTTED = 70;  // as many more where the trait of an organ is plotted

const byId = (id) => document.getElementById(id);

function start(about, shaders) {
    const clip = new Clip(about), canvas = byId("picture");
    const renderer = new Renderer(canvas, clip, shaders);
    const clock = new Clock(clip.times), camera = new Camera(clip.home, clip.axes);
    const look = { ...clip.look, byTrack: clip.look.byTrack || !clip.colored, chosen: -1, trait: clip.plotted[0] };
    const state = { dirty: true, moved: 0, turning: clip.look.turning, fitted: true, level: 0, pace: 0 };
    const move = () => { state.fitted = false; state.moved = performance.now(); };

    // Share of the picture's height that the plant has.
    function free() {
        const covered = COVERED + (byId("curve").hidden ? 0 : PLOTTED);
        return Math.max(1 - covered / canvas.clientHeight, 0.4);
    }

    function fit() {
        camera.fit(canvas.clientWidth / canvas.clientHeight, free());
        state.fitted = true;
    }

    const actions = {
        play: () => clock.toggle(),
        step: (direction) => clock.step(direction),
        nudge: (share) => clock.nudge(share),
        fit,
        turn: () => { state.turning = !state.turning; },
        color: () => { look.byTrack = !clip.colored || !look.byTrack; },
        ground: () => { look.light = !look.light; },
        organs: () => byId("organs").toggleAttribute("hidden"),
        choose: (track) => { look.chosen = look.chosen === track ? -1 : track; },
        trait: () => {
            look.trait = clip.plotted[(clip.plotted.indexOf(look.trait) + 1) % clip.plotted.length];
        },
        go: (day) => clock.go(day),
        fullscreen: () => (document.fullscreenElement
            ? document.exitFullscreen() : document.documentElement.requestFullscreen()),
        help: () => byId("help").toggleAttribute("hidden"),
        leave: () => { byId("help").hidden = true; byId("organs").hidden = true; },
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
            button.classList.toggle("on", Number(button.dataset.track) === look.chosen));
        plot();
    }

    // A trait or mean field of the chosen organ over the timeline, whose days it shares.
    function plot() {
        const [label, curve] = clip.curves[`${look.chosen} ${look.trait}`] || [];
        const before = free();
        byId("curve").hidden = !curve;
        camera.zoom(free() / before, 0, 0.5);
        if (!curve) return;
        const [place, , name] = byId("curve").children;
        place.innerHTML = curve;
        name.textContent = label;
    }

    // Where the clock stands, in words and on the timeline.
    function tell() {
        const [date, elapsed] = clip.namesOf(clock.day);
        byId("time").value = clock.day;
        byId("time").setAttribute("aria-valuetext", date);
        byId("date").textContent = date;
        byId("curve").children[1].style.left =
            `${(100 * (clock.day - clock.first)) / (clock.last - clock.first)}%`;
        byId("elapsed").textContent = elapsed;
    }

    // At a level of LEVELS; at rest everything is drawn, with four samples where that is quick.
    function draw(level, rest = true) {
        const scale = 0.8 ** level * Math.min(window.devicePixelRatio || 1, 2);
        const [width, height] = [canvas.clientWidth, canvas.clientHeight].map(
            (length) => Math.max(Math.round(length * scale), 1));
        if (canvas.width !== width || canvas.height !== height) Object.assign(canvas, { width, height });
        const samples = rest && state.level === 0 && width * height < SUPERSAMPLED ? 2 : 1;
        const every = Math.min(2 ** level, renderer.thinned(clock.day, FEWEST));
        renderer.draw(clock.day, camera, look, { every, samples });
        state.dirty = false;
    }

    // Fewer pixels and points while things move on a slow machine; all of them at rest.
    function adapt(milliseconds) {
        state.pace += milliseconds > SLOW ? 1 : milliseconds < FAST ? -0.2 : 0;
        if (Math.abs(state.pace - 1) < 1.5) return;
        const steps = state.pace > 0 ? Math.max(Math.round(Math.log2(milliseconds / SLOW)), 1) : -1;
        state.level = clamped(state.level + steps, 0, LEVELS - 1);
        state.pace = 0;
    }

    let before = performance.now(), lively = false;
    function frame(now) {
        requestAnimationFrame(frame);
        const passed = Math.min(now - before, 250), [needed] = clip.locate(clock.day);
        before = now;
        byId("waiting").hidden = renderer.ready(needed);
        if (!renderer.ready(needed)) return;
        for (const near of [needed + 1, needed - 1]) if (clip.intervals[near]) renderer.ready(near);
        const moving = clock.playing || state.turning || now - state.moved < 200;
        if (state.turning) camera.orbit((0.35 * passed) / 1000, 0);
        if (moving && lively) adapt(passed);
        if (moving || state.dirty || lively) {
            draw(moving ? state.level : 0, !moving);
            tell();
        }
        lively = moving;
        if (clock.playing) clock.tick(passed / 1000);
    }

    byId("time").addEventListener("input", ({ target: time }) => {
        const close = (SNAP * (clock.last - clock.first)) / time.clientWidth;
        act("go", clip.times.find((scan) => Math.abs(scan - time.value) < close) ?? Number(time.value));
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
            for (const k of [index, index - 1]) while (k >= 0 && !renderer.ready(k)) await nextTurn();
            act("leave");
            draw(0);
            tell();
        },
    };
}

const KEYS = {
    " ": ["play"], f: ["fit"], t: ["turn"], c: ["color"], g: ["ground"], o: ["organs"], l: ["trait"],
    h: ["help"], "?": ["help"], Escape: ["leave"], Home: ["go", -Infinity], End: ["go", Infinity],
    ArrowLeft: ["nudge", -0.01], ArrowRight: ["nudge", 0.01], PageUp: ["step", -1], PageDown: ["step", 1],
};

// One pointer turns the plant; with shift, another button or two fingers it is moved and zoomed.
function listen(canvas, camera, act, move) {
    const pointers = new Map();  // those pressed: picture heights from the middle of the canvas
    const place = ({ clientX, clientY }) => [
        (clientX - canvas.clientWidth / 2) / canvas.clientHeight, 0.5 - clientY / canvas.clientHeight];
    const gesture = () => {  // the middle of the first two pointers, and their distance
        const [[x, y], [u, v] = [x, y]] = pointers.values();
        return [(x + u) / 2, (y + v) / 2, Math.hypot(x - u, y - v)];
    };
    canvas.addEventListener("pointerdown", (event) => {
        canvas.setPointerCapture(event.pointerId);
        pointers.set(event.pointerId, place(event));
        canvas.focus({ preventScroll: true });
    });
    canvas.addEventListener("pointermove", (event) => {
        if (!pointers.has(event.pointerId)) return;
        const [u, v, apart] = gesture();
        pointers.set(event.pointerId, place(event));
        const [x, y, wide] = gesture();
        if (pointers.size > 1 || event.shiftKey || event.buttons & 6) camera.pan(x - u, y - v);
        else camera.orbit(Math.PI * (u - x), Math.PI * (v - y));
        if (apart > 0 && wide > 0) camera.zoom(wide / apart, x, y);
        move();
    });
    canvas.addEventListener("lostpointercapture", (event) => pointers.delete(event.pointerId));
    canvas.addEventListener("contextmenu", (event) => event.preventDefault());
    canvas.addEventListener("dblclick", () => act("fit"));
    canvas.addEventListener("wheel", (event) => {
        event.preventDefault();
        const notches = clamped(event.deltaY / (event.deltaMode === 1 ? 3 : 100), -5, 5);
        camera.zoom(1.12 ** -notches, ...place(event));
        move();
    }, { passive: false });
    document.addEventListener("keydown", (event) => {
        if (event.ctrlKey || event.metaKey || event.altKey) return;
        const page = event.shiftKey && { ArrowLeft: "PageUp", ArrowRight: "PageDown" }[event.key];
        const action = KEYS[page || event.key] || KEYS[event.key.toLowerCase()];
        if (!action || (event.key === " " && event.target.tagName === "BUTTON")) return;
        event.preventDefault();
        act(...action);
    });
    document.querySelectorAll("[data-do]").forEach((button) =>
        button.addEventListener("click", () => act(button.dataset.do, Number(button.dataset.track))));
}

function complain(error) {
    byId("waiting").hidden = true;
    byId("trouble").hidden = false;
    byId("trouble").textContent = error.message || String(error);
}

window.addEventListener("error", (event) => complain(event.error));
window.addEventListener("unhandledrejection", (event) => complain(event.reason));
if (typeof DecompressionStream === "undefined") {
    throw new Error("This browser is too old to unpack the plant; one from 2023 or later can.");
}
// The page first: a graphics driver may take a while to begin.
requestAnimationFrame(() => setTimeout(() =>
    start(...["clip", "shaders"].map((id) => JSON.parse(byId(id).textContent)))));
