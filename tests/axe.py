"""axe-core, which finds faults of accessibility, from npm."""

import json
import shutil
import subprocess
import tarfile
import tempfile
from pathlib import Path

import pytest

VERSION = "4.14.1"
KEPT = Path.home() / ".cache" / "restitution-tests" / f"axe-core-{VERSION}.js"
# Run in a page, with `script()`: a promise of the serious faults, each as one text.
RUN = """axe.run().then(({ violations }) => violations
  .filter(({ impact }) => ["serious", "critical"].includes(impact))
  .map(({ id, nodes }) => `${id}: ${nodes.map((node) => node.html.slice(0, 200)).join(" ")}`))"""


def script():
    """The source of axe-core; skips the test where it cannot be had."""
    if not KEPT.is_file():
        _fetch()
    return KEPT.read_text(encoding="utf-8")


def _fetch():
    if shutil.which("npm") is None:
        pytest.skip("npm, from which axe-core comes, is not installed")
    with tempfile.TemporaryDirectory() as folder:
        pack = ["npm", "pack", "--json", f"axe-core@{VERSION}"]
        done = subprocess.run(pack, cwd=folder, capture_output=True, text=True, timeout=300)
        if done.returncode != 0:
            pytest.skip(f"npm has no axe-core {VERSION}: {done.stderr.strip()[-200:]}")
        (packed,) = json.loads(done.stdout)
        with tarfile.open(Path(folder) / packed["filename"]) as archive:
            source = archive.extractfile("package/axe.min.js").read()
    KEPT.parent.mkdir(parents=True, exist_ok=True)
    KEPT.write_bytes(source)
