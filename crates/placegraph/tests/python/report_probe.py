"""A script that tries a report's page in a browser, and tells what it found to a server on this machine."""

import http.server
import json
import queue
import subprocess
import tempfile
import threading

PROBE = """
<script>
const probed = (found) => fetch("/probed", { method: "POST", body: JSON.stringify(found) });
addEventListener("error", (event) => probed({ error: event.message }));
addEventListener("unhandledrejection", (event) => probed({ error: String(event.reason) }));
addEventListener("load", async () => {
  const { viewer, shown } = globalThis.placegraph;
  await shown;
  const { data, camera } = viewer;
  const byId = (id) => document.getElementById(id);
  byId("show-specks").click();
  const rows = document.querySelectorAll("#places tbody tr").length;
  byId("show-graph").click();
  const hidden = !viewer.shown.graph;
  byId("show-graph").click();
  const before = camera.scale;
  byId("map").dispatchEvent(new KeyboardEvent("keydown", { key: "+" }));
  const zoomed = camera.scale > before;
  document.querySelector("#places tbody button").click();
  const chosen = document.querySelectorAll("tr.chosen").length === 1 && viewer.selected !== null;
  byId("zoom-fit").click();
  const box = byId("map").getBoundingClientRect();
  const point = (place) => {
    const [x, y] = camera.toScreen(place.at);
    byId("map").dispatchEvent(new PointerEvent("pointermove", { clientX: box.x + x, clientY: box.y + y }));
    return byId("tip").textContent;
  };
  const tip = point(data.places.find((place) => data.placeAt(place.at) === place));
  const doorway = data.byId.get(@DOORWAY@);
  const doorwayTip = doorway ? point(doorway) : "";
  const at = byId("at").textContent;
  const free = viewer.occupancy.values.filter((value) => value === 255).length;
  probed({ rows, places: data.places.length, hidden, zoomed, chosen, tip, at, doorwayTip, free });
});
</script>
"""


def run(browser, html, doorway):
    """What the probe finds in a report, in a browser that takes the time it needs; `doorway` is the number of a place, or 0."""
    html = html.replace("<script type=", PROBE.replace("@DOORWAY@", str(doorway)) + "<script type=", 1)
    told = queue.Queue()

    class Server(http.server.BaseHTTPRequestHandler):
        def do_GET(self):
            self.send_response(200 if self.path == "/" else 404)
            self.send_header("Content-Type", "text/html; charset=utf-8")
            self.end_headers()
            if self.path == "/":
                self.wfile.write(html.encode())

        def do_POST(self):
            told.put(json.loads(self.rfile.read(int(self.headers["Content-Length"]))))
            self.send_response(204)
            self.end_headers()

        def log_message(self, *_):
            pass

    with (
        http.server.ThreadingHTTPServer(("127.0.0.1", 0), Server) as server,
        tempfile.TemporaryDirectory(ignore_cleanup_errors=True) as scratch,
    ):
        threading.Thread(target=server.serve_forever, daemon=True).start()
        flags = ["--headless", "--no-sandbox", "--disable-gpu", f"--user-data-dir={scratch}/profile", "--window-size=1400,1000"]
        running = subprocess.Popen(
            [browser, *flags, f"http://127.0.0.1:{server.server_port}/"], stdout=subprocess.DEVNULL, stderr=subprocess.DEVNULL
        )
        try:
            return told.get(timeout=120)
        finally:
            running.kill()
            running.wait()
            server.shutdown()
