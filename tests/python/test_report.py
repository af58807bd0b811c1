"""The page of a run, opened in a browser: what it draws, says and lets do."""

import base64
import gzip
import json
import re
import shutil

import numpy as np
import pytest
import saltus.kernel as sk
from saltus.examples.bouncing_ball import bouncing_ball
from saltus.examples.disc_pile import disc_pile
from saltus.examples.gallery import examples
from saltus.examples.heavy_top import heavy_top
from saltus.examples.slider_crank import slider_crank
from saltus.io import ContactState, Trajectory
from saltus.io.records import Loaded

webdriver = pytest.importorskip("selenium.webdriver")
LIMIT = 3_000_000  #: bytes of a page


@pytest.fixture(scope="module")
def browser():
    if not (shutil.which("chromium") and shutil.which("chromedriver")):
        pytest.skip("chromium and chromedriver are not installed")
    options = webdriver.ChromeOptions()
    options.binary_location = shutil.which("chromium")
    for argument in ("--headless", "--no-sandbox", "--disable-dev-shm-usage", "--window-size=1280,1600"):
        options.add_argument(argument)
    options.set_capability("goog:loggingPrefs", {"browser": "ALL"})
    service = webdriver.ChromeService(shutil.which("chromedriver"))
    driver = webdriver.Chrome(options=options, service=service)
    yield driver
    driver.quit()


@pytest.fixture(scope="module")
def crank():
    return sk.TimeStepping(slider_crank.build(), "HalfExplicitTrapezoidalOSI", 1e-5).run(0.1)


class Opened:
    """A page in the browser."""

    def __init__(self, browser, path):
        self.browser = browser
        browser.get_log("browser")
        browser.get(path.as_uri())
        self.wait("window.saltusPage !== undefined")

    def __call__(self, script, *arguments):
        return self.browser.execute_script(f"return {script}", *arguments)

    def wait(self, condition):
        from selenium.webdriver.support.ui import WebDriverWait

        WebDriverWait(self.browser, 20).until(lambda driver: driver.execute_script(f"return {condition}"))

    def errors(self):
        return [entry["message"] for entry in self.browser.get_log("browser") if entry["level"] != "INFO"]

    def press(self, *keys):
        body = self.browser.find_element("tag name", "body")
        body.send_keys(*keys)

    def picture(self):
        return self("document.getElementById('scene').toDataURL()")

    def time(self):
        return self("window.saltusPage.time")


@pytest.fixture(scope="module")
def opened(browser, crank, tmp_path_factory):
    path = crank.report(
        tmp_path_factory.mktemp("report") / "crank.html", title="Slider crank", caption="It hits."
    )
    assert path.stat().st_size < LIMIT
    return Opened(browser, path)


def texts(path):
    page = path.read_text(encoding="utf-8")
    return json.loads(re.search(r'<script id="run"[^>]*>(.*?)</script>', page, flags=re.DOTALL)[1])


def numbers(path, name):
    page = path.read_text(encoding="utf-8")
    packed = re.search(r'<script id="numbers"[^>]*>(.*?)</script>', page, flags=re.DOTALL)[1]
    kind, offset, count = texts(path)["arrays"][name]
    data = gzip.decompress(base64.b64decode(packed))
    return np.frombuffer(data, dtype=np.dtype(kind), count=count, offset=offset)


def test_the_page_opens_without_errors(opened):
    assert opened.errors() == []
    assert opened("document.title") == "Slider crank"
    assert opened("document.getElementById('caption').textContent") == "It hits."
    # nothing is loaded from elsewhere
    assert opened("performance.getEntriesByType('resource').length") == 0


def test_the_animation_moves(opened):
    opened("window.saltusPage.seek(0)")
    first = opened.picture()
    opened("document.getElementById('play').click()")
    opened.wait("window.saltusPage.time > 0.002")
    opened("document.getElementById('play').click()")
    assert not opened("window.saltusPage.playing")
    assert opened.picture() != first


def test_shapes_are_drawn_where_they_are(opened, crank):
    # the middle of the slider, between rows: interpolated, and in the middle of its drawn corners
    time = 0.5 * (crank.t[4000] + crank.t[4001])
    opened(f"window.saltusPage.seek({time})")
    placed = opened(
        "(() => { const p = window.saltusPage, s = p.scene.shapes[2], r = rowAt(p.t, p.time);"
        " const f = (p.time - p.t[r]) / (p.t[r + 1] - p.t[r]); return Array.from(place(s, r, r + 1, f)); })()"
    )
    box = crank.shapes[2]
    between = 0.5 * (box.in_space(4000) + box.in_space(4001))
    np.testing.assert_allclose(np.reshape(placed, (-1, 3)), between, atol=1e-5)


def test_plots_carry_the_extremes(opened, crank):
    data = opened("window.saltusPage.plots.plots.map((plot) => plot.data)")
    panels = opened("window.saltusPage.run.panels")
    by_title = {panel["title"]: (panel, columns) for panel, columns in zip(panels, data, strict=True)}
    for title, column in [
        ("Gaps g", "gap"),
        ("Relative velocities γ", "velocity"),
        ("Contact forces λ", "force"),
        ("Impulses Λ", "impulse"),
    ]:
        panel, columns = by_title[title]
        assert len(panel["lines"]) == crank.columns()[column].shape[1]
        for line, values in zip(panel["lines"], columns[1:], strict=True):
            exact = getattr(crank[line["contact"]], column)[:, line["row"]]
            assert min(values) == pytest.approx(exact.min(), rel=1e-6, abs=1e-12)
            assert max(values) == pytest.approx(exact.max(), rel=1e-6, abs=1e-12)
    assert max(by_title["Energy"][1][1]) == pytest.approx(crank.energy.max(), rel=1e-6)
    assert by_title["Step size"][1][1][7] == pytest.approx(1e-5)
    assert opened("window.saltusPage.plots.plots[1].root.querySelector('canvas').width") > 100


def test_events_are_those_of_the_run(opened, crank):
    rows = opened(
        "[...document.querySelectorAll('#events tbody tr')]"
        ".map((row) => [...row.cells].map((cell) => cell.textContent))"
    )
    first = np.flatnonzero(crank.impulsive)[0]
    hit = [name for name in crank.contacts if crank[name].impulse[first, 0] > 0]
    together = sum(float(np.linalg.norm(crank[name].impulse[first])) for name in hit)
    assert rows[0][0] == f"{crank.t[first]:.6g} s"
    assert rows[0][1] == ", ".join(hit)
    assert float(re.search(r"hits with (\S+) N s", rows[0][2])[1]) == pytest.approx(together, rel=1e-2)
    assert rows[0][2].endswith("bounces")
    slides = [row for row in rows if row[2].endswith("slides")]
    assert slides
    assert all("upper" in row[1] or "lower" in row[1] for row in slides)
    # a click moves the animation there
    opened("document.querySelector('#events tbody button').click()")
    assert opened.time() == pytest.approx(crank.t[first])
    assert "upper left: impact" in opened("document.getElementById('now').textContent")


def test_contacts_are_lit_by_what_they_do(opened, crank):
    states = opened("window.saltusPage.run.states")
    sliding = np.flatnonzero(crank["upper left"].states == states.index("SLIP"))
    time = crank.t[sliding[-10]]
    opened(f"window.saltusPage.seek({time})")
    assert "upper left: slides" in opened("document.getElementById('now').textContent")
    found = opened(
        "(() => { const p = window.saltusPage, v = p.run.values, r = rowAt(p.t, p.time), found = [];"
        " for (let k = v.arrow_start[r]; k < v.arrow_start[r + 1]; ++k)"
        " found.push([p.run.arrow_names[v.arrow_contact[k]], p.run.states[v.arrow_state[k]],"
        " Array.from(v.arrow_force.slice(3 * k, 3 * k + 3))]); return found; })()"
    )
    entry = next(entry for entry in found if entry[0] == "upper left")
    row = int(np.argmin(np.abs(crank.t - time)))
    normal, tangential = crank["upper left"].force[row]
    assert entry[1] == "SLIP"
    np.testing.assert_allclose(entry[2], [tangential, -normal, 0.0], rtol=1e-5)


def test_keys(opened, crank):
    from selenium.webdriver.common.keys import Keys

    opened("window.saltusPage.seek(0)")
    opened.press(Keys.ARROW_RIGHT)
    assert opened.time() == pytest.approx(crank.t[1])
    opened.press(Keys.ARROW_LEFT)
    assert opened.time() == 0
    opened.press("n")
    assert opened.time() == pytest.approx(crank.t[np.flatnonzero(crank.impulsive)[0]])
    opened.press(Keys.END)
    assert opened.time() == pytest.approx(crank.t[-1])
    opened.press(Keys.HOME, " ")
    assert opened("window.saltusPage.playing")
    opened.press(" ")
    assert not opened("window.saltusPage.playing")
    opened.press("0", "+")
    low, high = opened("window.saltusPage.range")
    assert high - low == pytest.approx(0.05, rel=0.5)
    scales = opened("window.saltusPage.plots.plots.map((plot) => [plot.scales.x.min, plot.scales.x.max])")
    assert all(scale == pytest.approx([low, high]) for scale in scales)
    opened.press("0")
    assert opened("window.saltusPage.range") == pytest.approx([0.0, 0.1])
    assert opened.errors() == []


def test_everything_can_be_reached_by_keys(opened):
    reached = opened(
        "[...document.querySelectorAll('button, input, select, summary, .scrolled')]"
        ".every((element) => element.tabIndex >= 0)"
    )
    assert reached
    unnamed = opened(
        "[...document.querySelectorAll('button, input, select')]"
        ".filter((e) => !(e.textContent.trim() || e.ariaLabel || e.labels?.length)).map((e) => e.outerHTML)"
    )
    assert unnamed == []


def test_contacts_can_be_taken_out_of_the_plots(opened):
    shown = "window.saltusPage.plots.plots[1].series.map((s) => s.show)"
    assert all(opened(shown))
    opened("document.querySelector('#chooser input').click()")
    assert opened(shown) == [True, False, True, True, True]
    opened("document.querySelector('#chooser input').click()")


def test_a_phone_needs_no_sideways_scrolling(opened):
    opened.browser.execute_cdp_cmd(
        "Emulation.setDeviceMetricsOverride",
        {"width": 360, "height": 740, "deviceScaleFactor": 2, "mobile": True},
    )
    try:
        opened.wait("document.documentElement.clientWidth === 360")
        assert opened("document.documentElement.scrollWidth") <= 360
        assert opened("document.getElementById('scene').clientWidth") > 300
    finally:
        opened.browser.execute_cdp_cmd("Emulation.clearDeviceMetricsOverride", {})


def test_space(browser, tmp_path):
    run = sk.TimeStepping(heavy_top.build(), heavy_top.SCHEME, 1e-3).run(0.5)
    page = Opened(browser, run.report(tmp_path / "top.html"))
    assert page("window.saltusPage.run.spatial")
    first = page.picture()
    page("window.saltusPage.seek(0.25)")
    assert page.picture() != first
    turned = page.picture()
    page("window.saltusPage.scene.view.move(40, 10, false)")
    page("window.saltusPage.draw()")
    assert page.picture() != turned
    assert page.errors() == []


def test_many_contacts(browser, tmp_path):
    run = sk.TimeStepping(disc_pile.build(), disc_pile.SCHEME, 1e-3).run(0.5)
    path = run.report(tmp_path / "pile.html")
    assert path.stat().st_size < LIMIT
    page = Opened(browser, path)
    assert page.errors() == []
    assert page("window.saltusPage.run.contacts.length") == 60
    assert page("window.saltusPage.run.more_contacts") == len(run.contacts) - 60


def test_long_runs_keep_impacts_and_extremes(tmp_path):
    run = sk.TimeStepping(bouncing_ball.build(), "HalfExplicitTrapezoidalOSI", 2e-6).run(1.0)
    path = run.report(tmp_path / "ball.html")
    assert path.stat().st_size < LIMIT
    t = numbers(path, "t")
    assert len(t) < len(run) == 500001
    assert np.isin(run.t[run.impulsive], t).all()
    panel = next(k for k, panel in enumerate(texts(path)["panels"]) if panel["title"] == "Gaps g")
    gaps = numbers(path, f"panel{panel}.0")
    assert gaps.min() == pytest.approx(run["floor"].gap.min())
    assert gaps.max() == pytest.approx(run["floor"].gap.max())


def test_names_cannot_break_the_page(browser, tmp_path):
    ball = sk.LagrangianLinearTIDS([1.0], [0.0], [[1.0]], external_force=[-9.81])
    evil = "</script><script>window.broken = true</script><img src=x onerror='window.broken = true'>"
    system = sk.NonSmoothDynamicalSystem([ball], parameters={evil: evil})
    system.link(sk.Interaction(sk.LagrangianLinearTIR([[1.0]]), sk.NewtonImpactNSL(0.5), name=evil), ball)
    run = sk.TimeStepping(system, "HalfExplicitTrapezoidalOSI", 1e-3).run(1.0)
    page = Opened(browser, run.report(tmp_path / "evil.html", title=evil, caption=evil))
    assert page.errors() == []
    assert page("document.title") == evil
    assert not page("window.broken")
    assert evil in page("document.getElementById('events').textContent")
    assert "add_shape" in page("document.getElementById('animation').textContent")


@pytest.mark.parametrize("until", [0.0, 1e-3])
def test_runs_of_a_row_or_two(browser, tmp_path, until):
    run = sk.TimeStepping(bouncing_ball.build(), "HalfExplicitTrapezoidalOSI", 1e-3).run(until)
    page = Opened(browser, run.report(tmp_path / "short.html"))
    assert page.errors() == []
    assert page.time() == 0


def test_targets_that_cannot_be_written(tmp_path):
    run = sk.TimeStepping(bouncing_ball.build(), "HalfExplicitTrapezoidalOSI", 1e-3).run(0.01)
    with pytest.raises(OSError, match="cannot write .*nowhere"):
        run.report(tmp_path / "nowhere" / "page.html")
    with pytest.raises(OSError, match="cannot write"):
        run.report(tmp_path)
    assert list(tmp_path.iterdir()) == []


RUNS = {}


def example_run(name):
    if name not in RUNS:
        RUNS[name] = examples()[name].run()
    return RUNS[name]


@pytest.mark.parametrize("name", sorted(examples()))
def test_pages_of_the_examples(browser, tmp_path, name):
    run, example = example_run(name), examples()[name]
    path = run.report(tmp_path / f"{name}.html", title=name, caption=example.WATCH)
    assert path.stat().st_size < LIMIT
    page = Opened(browser, path)
    assert page.errors() == []
    assert page("document.getElementById('caption').textContent") == example.WATCH
    assert page("window.saltusPage.run.shapes.length") > 0
    first = page.picture()
    page("window.saltusPage.move(0.37 * window.saltusPage.run.span[1])")
    assert page.picture() != first
    # every contact that acts is seen, but the welds of the rotor, whose page shows a section
    shown = set(page("window.saltusPage.run.arrow_names"))
    acting = {c for c in run.contacts if run[c].force.any() or run[c].impulse.any()}
    assert acting - shown <= {"flywheel weld", "frustum weld"}


def states(name, contact):
    return example_run(name)[contact].states


def test_what_the_captions_say():
    last = {
        name: {c: states(name, c)[-1] for c in example_run(name).contacts}
        for name in ("ball_in_box", "disc_pile")
    }
    closed = {c for c, state in last["ball_in_box"].items() if state != ContactState.OPEN}
    assert closed == {"left", "bottom"}
    assert ContactState.SLIP not in last["disc_pile"].values()
    assert ContactState.STICK in last["disc_pile"].values()
    crank = example_run("slider_crank")
    assert not any((states("slider_crank", c) == ContactState.STICK).any() for c in crank.contacts)
    hit = np.flatnonzero(crank.impulsive)[0]
    assert {c for c in crank.contacts if crank[c].states[hit] == ContactState.IMPACT} == {
        "upper left",
        "upper right",
    }
    block = {side: states("rocking_block", side) for side in ("left", "right")}
    assert all((s == ContactState.STICK).any() and s[-1] == ContactState.STICK for s in block.values())
    sphere = states("rolling_sphere", "plane")
    assert sphere[1] == ContactState.SLIP
    assert sphere[-1] == ContactState.STICK
    friction = example_run("dry_friction")
    assert friction["plane"].states[-1] == ContactState.STICK
    assert abs(friction.q[-1, 0]) > 0.01
    assert friction["plane"].force[-1, 1] * friction.q[-1, 0] > 0  # against the spring
    assert (states("woodpecker", "lower") == ContactState.STICK).any()
    assert (states("woodpecker", "upper") == ContactState.IMPACT).any()
    assert (states("woodpecker", "beak") == ContactState.IMPACT).any()
    bounces = example_run("bouncing_ball")["floor"].impulse[:, 0]
    bounces = bounces[bounces > 0.1]  # shorter flights end at a row by chance
    assert (np.diff(bounces) < 0).all()
    stops = example_run("impact_oscillator")["stop"].impulse[:, 0]
    assert np.ptp(stops[stops > 0]) < 0.02 * stops.max()
    cradle = example_run("newtons_cradle")
    first = [np.flatnonzero(cradle[c].impulse[:, 0])[0] for c in cradle.contacts]
    assert first == sorted(first)


def test_a_first_order_run(browser, tmp_path):
    point = sk.FirstOrderLinearTIDS([1.0])
    system = sk.FirstOrderSystem([point])
    system.link(sk.FirstOrderLinearTIR([[1.0]], [[1.0]]), sk.RelayNSL(1, -1.0, 1.0), point, name="relay")
    run = sk.FirstOrderTimeStepping(system, sk.EulerMoreauOSI(1.0), 1e-2).run(2.0)
    page = Opened(browser, run.report(tmp_path / "relay.html", title="Relay"))
    assert page.errors() == []
    assert page("document.getElementById('animation').hidden")
    titles = page("window.saltusPage.run.panels.map((panel) => panel.title)")
    data = page("window.saltusPage.plots.plots.map((plot) => plot.data)")
    states = data[titles.index("States x")][1]
    np.testing.assert_allclose(states, run.x[:, 0], atol=1e-6)
    assert max(data[titles.index("Multipliers λ")][1]) == pytest.approx(run.lambda_.max())


def test_a_scheme_with_forces_is_not_said_to_have_none(tmp_path):
    # its run ends before anything is carried
    run = sk.TimeStepping(bouncing_ball.build(), "HalfExplicitTrapezoidalOSI", 1e-3).run(0.6)
    assert run.impulsive.any()
    notes = {panel["title"]: panel["note"] for panel in texts(run.report(tmp_path / "run.html"))["panels"]}
    assert notes["Contact forces λ"] == "Mean over the step."


def test_times_that_differ_are_written_differently(opened):
    opened("window.saltusPage.zoom([0.0500, 0.0501])")
    opened("window.saltusPage.plots.plots[0].redraw()")
    ticks = opened("window.saltusPage.plots.plots[0].axes[0]._values")
    assert len(set(ticks)) == len(ticks) > 1
    assert opened("document.getElementById('shown').textContent") == "0.05 s to 0.0501 s"
    assert opened("[0.25, 0.5].map((v) => shortNumber(v, 0.25))") == ["0.25", "0.5"]
    opened("window.saltusPage.zoom(window.saltusPage.whole)")


def test_a_contact_that_flickers_does_not_burst_the_page(browser, tmp_path):
    run = sk.TimeStepping(bouncing_ball.build(), "HalfExplicitTrapezoidalOSI", 1e-5).run(2.0)
    columns = {name: np.array(values) for name, values in run.columns().items()}
    columns["force"][::2] = 1.0
    columns["force"][1::2] = 0.0
    columns["impulse"][1001] = np.inf
    flickering = Trajectory(Loaded(len(run), columns), run.layout, run.provenance)
    path = flickering.report(tmp_path / "flicker.html")
    assert path.stat().st_size < LIMIT
    page = Opened(browser, path)
    assert page.errors() == []
    assert "States change too often" in page("document.getElementById('more-events').textContent")


def test_texts_are_texts(tmp_path):
    run = sk.TimeStepping(bouncing_ball.build(), "HalfExplicitTrapezoidalOSI", 1e-3).run(0.01)
    with pytest.raises(TypeError, match="caption must be text, got int"):
        run.report(tmp_path / "page.html", caption=3)
