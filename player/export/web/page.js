// The page: puts clip, clock, camera and renderer together and lets people touch them.

// What is drawn while things move: share of the picture's width and height, one of so many movers
// as long as FEWEST are left, passes over them.
const LEVELS = [[1, 1, 2], [1, 1, 1], [0.8, 2, 1], [0.62, 4, 1], [0.5, 8, 1], [0.4, 16, 1]];
const FEWEST = 60000;
const SLICE = 100000;  // movers drawn in one go at rest, to begin with
const PATIENCE = 30;  // milliseconds that one go may take: who comes back to the page waits no longer
const HEAVY = 150000, FIRST = 3;  // movers from which a page begins at that level, not at the best
const SLOW = 45, FAST = 22;  // milliseconds a picture at which less, or more, is drawn

const byId = (id) => document.getElementById(id);

function start(about, shaders) {
    const clip = new Clip(about), canvas = byId("picture");
    const renderer = new Renderer(canvas, clip, shaders);
    const clock = new Clock(clip.times);
    const camera = new Camera({ ...clip.home, target: [...clip.home.target] }, clip.up, clip.radius);
    const look = { ...clip.look, byTrack: clip.look.byTrack || !clip.colored, chosen: -1 };
    const state = {
        dirty: true, moved: 0, turning: clip.look.turning, fitted: true,
        level: Math.max(...clip.intervals.map(({ count }) => count)) > HEAVY ? FIRST : 0, pace: 0,
        steps: null, slice: SLICE, fence: null, sent: 0,
    };
    const show = () => { state.dirty = true; };
    const move = () => { state.dirty = true; state.fitted = false; state.moved = performance.now(); };

    function fit() {
        Object.assign(camera, clip.home, { target: [...clip.home.target] });
        const { clientWidth: width, clientHeight: height } = canvas;
        camera.fit(clip.outline, width / height, Math.max(1 - 130 / height, 0.4));
        state.fitted = true;
        show();
    }

    const actions = {
        play: () => clock.toggle(),
        previous: () => clock.step(-1),
        next: () => clock.step(1),
        back: () => clock.nudge(-0.01),
        on: () => clock.nudge(0.01),
        first: () => clock.go(clock.first),
        last: () => clock.go(clock.last),
        slower: () => clock.hasten(-1),
        faster: () => clock.hasten(1),
        fit,
        turn: () => { state.turning = !state.turning; },
        color: () => { look.byTrack = clip.colored ? !look.byTrack : true; },
        ground: () => { look.light = !look.light; },
        larger: () => { look.pointSize = Math.min(look.pointSize * 1.15, 20); },
        smaller: () => { look.pointSize = Math.max(look.pointSize / 1.15, 0.05); },
        organs: () => {
            if (!byId("organs").childElementCount) listOrgans(clip, choose);
            byId("organs").toggleAttribute("hidden");
        },
        fullscreen: () => (document.fullscreenElement
            ? document.exitFullscreen() : document.documentElement.requestFullscreen()),
        help: () => byId("help").toggleAttribute("hidden"),
        picture: () => { draw(LEVELS[0]); savePicture(canvas, `${clip.title} ${dateAt(clip, clock.day)}`); },
        leave: () => { byId("help").hidden = true; byId("organs").hidden = true; },
    };
    const act = (name) => { actions[name](); refresh(); show(); };

    const page = arrange(clip, clock, (day) => { clock.go(day); refresh(); show(); });
    function choose(track) {
        look.chosen = look.chosen === track ? -1 : track;
        refresh();
        show();
    }

    function refresh() {
        document.documentElement.dataset.ground = look.light ? "light" : "dark";
        page.refresh(state.turning, look);
    }

    function sizeOf(level) {
        const pixels = Math.min(window.devicePixelRatio || 1, 2) * level[0];
        return [canvas.clientWidth, canvas.clientHeight].map(
            (length) => Math.max(Math.round(length * pixels), 1));
    }

    function draw(level) {
        const every = Math.min(level[1], renderer.thinned(clock.day, FEWEST));
        state.steps = null;
        renderer.resize(sizeOf(LEVELS[0]));
        renderer.draw(clock.day, camera, look, sizeOf(level), every, level[2] === 1);
    }

    // The whole picture, at rest: at once where that is quick, else slice by slice, each sent when
    // the one before is done, so that the next touch is never kept waiting.
    function settle(fresh) {
        const quick = 2 * renderer.count(clock.day) <= state.slice;
        if (quick || state.level === 0) {
            draw(LEVELS[0]);
            return;
        }
        if (fresh) draw(LEVELS[state.level]);
        state.steps = renderer.steps(
            clock.day, camera, look, sizeOf(LEVELS[0]), 1, false, () => Math.round(state.slice));
    }

    function goOn() {
        const gl = renderer.gl, now = performance.now();
        if (state.fence) {
            if (gl.getSyncParameter(state.fence, gl.SYNC_STATUS) !== gl.SIGNALED) return;
            gl.deleteSync(state.fence);
            state.fence = null;
            const change = PATIENCE / Math.max(now - state.sent, 1);
            state.slice = Math.max(state.slice * Math.min(Math.max(change, 0.5), 2), 2000);
        }
        if (state.steps.next().done) {
            state.steps = null;
            return;
        }
        state.fence = gl.fenceSync(gl.SYNC_GPU_COMMANDS_COMPLETE, 0);
        state.sent = now;
        gl.flush();
    }

    // Fewer pixels and movers while things move on a slow machine; all of them at rest.
    function paced(milliseconds) {
        state.pace += milliseconds > SLOW ? 1 : milliseconds < FAST ? -0.2 : 0;
        if (state.pace > 2 && state.level < LEVELS.length - 1) {
            const steps = Math.max(Math.round(Math.log2(milliseconds / SLOW)), 1);
            state.level = Math.min(state.level + steps, LEVELS.length - 1);
            state.pace = 0;
        } else if (state.pace < -3) {
            state.level = Math.max(state.level - 1, 0);
            state.pace = 0;
        }
    }

    let before = performance.now(), lively = false;
    function frame(now) {
        requestAnimationFrame(frame);
        const passed = Math.min(now - before, 250);
        before = now;
        const needed = clip.locate(clock.day)[0];
        const there = renderer.ready(needed);
        if (needed + 1 < clip.intervals.length && there) renderer.ready(needed + 1);
        if (needed > 0 && there) renderer.ready(needed - 1);
        const waits = !renderer.compiled(clip.intervals[needed]) || !there;
        byId("waiting").hidden = !waits;
        if (waits) {
            const share = `${Math.round(100 * renderer.share(needed))}`;
            byId("waiting").style.setProperty("--share", share);
            byId("waiting").setAttribute("aria-valuenow", share);
            return;
        }
        const moving = clock.playing || state.turning || now - state.moved < 200;
        if (clock.playing) clock.tick(passed / 1000);
        if (!renderer.ready(clip.locate(clock.day)[0])) return;
        if (state.turning) camera.orbit((0.35 * passed) / 1000, 0);
        if (moving && lively) paced(passed);
        if (moving) draw(LEVELS[state.level]);
        else if (state.dirty || lively) settle(state.dirty);
        else if (state.steps) goOn();
        if (moving || state.dirty || lively) page.move();
        state.dirty = false;
        lively = moving;
    }

    listen(canvas, camera, { act, move, fit });
    new ResizeObserver(() => (state.fitted ? fit() : show())).observe(canvas);
    canvas.addEventListener("webglcontextlost", () => location.reload());
    clock.playing = !window.matchMedia("(prefers-reduced-motion: reduce)").matches;
    renderer.resize(sizeOf(LEVELS[0]));
    refresh();
    fit();
    requestAnimationFrame(frame);

    // For tests and for scripts in the browser's console.
    window.viewer = {
        clip, clock, camera, look, act, renderer, state, levels: LEVELS,
        async seek(day) {
            clock.playing = false;
            act("leave");
            clock.go(day);
            const [index] = clip.locate(day);
            for (const k of [index, index - 1]) if (k >= 0) await renderer.wait(k);
            refresh();
            draw(LEVELS[0]);
            page.move();
            state.dirty = false;
        },
        positions: (day) => renderer.positions(day),
    };
}

// The timeline and the buttons; gives what keeps them up to date.
function arrange(clip, clock, go) {
    const track = byId("track"), span = clip.last - clip.first;
    byId("title").textContent = clip.title;
    byId("facts").textContent = `${clip.times.length} scans, ${clip.tracks.length} organs`;
    document.querySelector('[data-do="color"]').hidden = !clip.colored;
    if (clip.scale) {
        const [title, ramp, ends] = byId("scale").children;
        title.textContent = clip.scale.title;
        ramp.style.background = `linear-gradient(to right, ${clip.scale.colors.join()})`;
        ends.textContent = `${clip.scale.low} to ${clip.scale.high}`;
    }
    const labels = clip.shortDates, room = Math.max(...labels.map((text) => text.length)) * 7 + 16;
    clip.times.forEach((time, i) => {
        const mark = document.createElement("div");
        mark.className = "mark";
        mark.style.left = `${(100 * (time - clip.first)) / span}%`;
        const label = document.createElement("span");
        label.textContent = labels[i];
        mark.append(label);
        track.append(mark);
    });

    // Leave out labels that would run into the one before, or into the last.
    const spaced = () => {
        let free = -Infinity;
        track.querySelectorAll(".mark span").forEach((label, i) => {
            const at = (track.clientWidth * (clip.times[i] - clip.first)) / span;
            const last = i === clip.times.length - 1;
            label.hidden = !last && (at < free || at > track.clientWidth - room);
            if (!label.hidden) free = at + room;
        });
    };
    new ResizeObserver(spaced).observe(track);

    const dayAt = (event) => {
        const { left, width } = track.getBoundingClientRect();
        const day = clip.first + span * Math.min(Math.max((event.clientX - left) / width, 0), 1);
        const near = clip.times.find((time) => Math.abs(time - day) < (5 * span) / width);
        return near === undefined ? day : near;
    };
    let resume = false;
    track.addEventListener("pointerdown", (event) => {
        track.setPointerCapture(event.pointerId);
        resume = clock.playing;
        clock.playing = false;
        go(dayAt(event));
    });
    track.addEventListener("pointermove", (event) => {
        if (track.hasPointerCapture(event.pointerId)) go(dayAt(event));
    });
    track.addEventListener("lostpointercapture", () => { clock.playing = resume; go(clock.day); });

    return {
        move() {
            const share = (clock.day - clip.first) / span, date = dateAt(clip, clock.day);
            byId("passed").style.width = byId("knob").style.left = `${100 * share}%`;
            if (byId("date").textContent !== date) byId("date").textContent = date;
            byId("elapsed").textContent = elapsed(clip, clock.day);
            track.setAttribute("aria-valuenow", share.toFixed(3));
            track.setAttribute("aria-valuetext", date);
        },
        refresh(turning, look) {
            document.body.classList.toggle("playing", clock.playing);
            document.querySelector('[data-do="turn"]').classList.toggle("on", turning);
            document.querySelector('[data-do="color"]').classList.toggle("on", look.byTrack);
            byId("scale").hidden = !clip.scale || look.byTrack;
            byId("speed").textContent = clock.speed === 1 ? "" : `${clock.speed}×`;
            document.querySelectorAll("#organs button").forEach((button) =>
                button.classList.toggle("on", Number(button.dataset.track) === look.chosen));
        },
    };
}

function listOrgans(clip, choose) {
    const list = byId("organs");
    clip.tracks.forEach(({ name, color, born, lost }, id) => {
        const button = document.createElement("button"), swatch = document.createElement("i");
        const label = document.createElement("span"), life = document.createElement("small");
        swatch.style.background = `rgb(${color.map(Number).join()})`;
        label.textContent = name;
        life.textContent = (born > clip.first ? dateAt(clip, born) : "")
            + (lost === null ? "" : ` – ${dateAt(clip, lost)}`);
        button.dataset.track = id;
        button.append(swatch, label, life);
        button.addEventListener("click", () => choose(id));
        list.append(button);
    });
}

function savePicture(canvas, name) {
    canvas.toBlob((blob) => {
        const link = document.createElement("a");
        link.href = URL.createObjectURL(blob);
        link.download = `${name.replace(/[^\w. -]+/g, "-")}.png`;
        link.click();
        setTimeout(() => URL.revokeObjectURL(link.href), 1000);
    });
}

const KEYS = {
    " ": "play", ArrowLeft: "back", ArrowRight: "on", PageUp: "previous", PageDown: "next",
    Home: "first", End: "last", ArrowDown: "slower", ArrowUp: "faster", "[": "slower", "]": "faster",
    f: "fit", t: "turn", F11: null, c: "color", g: "ground", "+": "larger", "=": "larger",
    "-": "smaller", o: "organs", s: "picture", h: "help", "?": "help", Escape: "leave",
};

// One pointer turns the plant; with shift, another button or two fingers it is moved and zoomed.
function listen(canvas, camera, { act, move, fit }) {
    const pointers = new Map();
    const middle = () => {
        const [a, b] = [...pointers.values()];
        return b ? [(a[0] + b[0]) / 2, (a[1] + b[1]) / 2, Math.hypot(a[0] - b[0], a[1] - b[1])] : null;
    };
    const about = (x, y) => {  // picture heights from the middle of the canvas
        const { left, top, width, height } = canvas.getBoundingClientRect();
        return [(x - left - width / 2) / height, (top + height / 2 - y) / height];
    };
    canvas.addEventListener("pointerdown", (event) => {
        canvas.setPointerCapture(event.pointerId);
        pointers.set(event.pointerId, [event.clientX, event.clientY]);
        canvas.focus({ preventScroll: true });
    });
    canvas.addEventListener("pointermove", (event) => {
        const last = pointers.get(event.pointerId);
        if (!last) return;
        const pinch = middle(), height = canvas.clientHeight;
        const right = (event.clientX - last[0]) / height, down = (event.clientY - last[1]) / height;
        pointers.set(event.pointerId, [event.clientX, event.clientY]);
        if (pinch) {
            const now = middle();
            camera.pan((now[0] - pinch[0]) / height, (pinch[1] - now[1]) / height);
            camera.zoom(now[2] / Math.max(pinch[2], 1), ...about(now[0], now[1]));
        } else if (event.shiftKey || event.buttons & 6) {
            camera.pan(right, -down);
        } else {
            camera.orbit(-Math.PI * right, Math.PI * down);
        }
        move();
    });
    const forget = (event) => pointers.delete(event.pointerId);
    canvas.addEventListener("lostpointercapture", forget);
    canvas.addEventListener("pointercancel", forget);
    canvas.addEventListener("contextmenu", (event) => event.preventDefault());
    canvas.addEventListener("dblclick", fit);
    canvas.addEventListener("wheel", (event) => {
        event.preventDefault();
        const notches = event.deltaY / (event.deltaMode === 1 ? 3 : 100);
        camera.zoom(1.12 ** -Math.min(Math.max(notches, -5), 5), ...about(event.clientX, event.clientY));
        move();
    }, { passive: false });
    document.addEventListener("keydown", (event) => {
        if (event.ctrlKey || event.metaKey || event.altKey) return;
        const arrow = event.shiftKey && { ArrowLeft: "previous", ArrowRight: "next" }[event.key];
        const name = arrow || KEYS[event.key] || KEYS[event.key.toLowerCase()];
        if (!name || (event.key === " " && event.target.tagName === "BUTTON")) return;
        event.preventDefault();
        act(name);
    });
    document.querySelectorAll("[data-do]").forEach((button) =>
        button.addEventListener("click", () => act(button.dataset.do)));
}

function complain(error) {
    byId("waiting").hidden = true;
    byId("trouble").hidden = false;
    byId("trouble").textContent = error.message || String(error);
}

window.addEventListener("unhandledrejection", (event) => complain(event.reason));
try {
    if (typeof DecompressionStream === "undefined") {
        throw new Error("This browser is too old to unpack the plant; one from 2023 or later can.");
    }
    const read = (id) => JSON.parse(byId(id).textContent);
    // The page first: a graphics driver may take a while to begin.
    requestAnimationFrame(() => setTimeout(() => {
        try {
            start(read("clip"), read("shaders"));
        } catch (error) {
            complain(error);
        }
    }));
} catch (error) {
    complain(error);
}
