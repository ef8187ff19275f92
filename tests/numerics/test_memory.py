import math
import re
import subprocess
import sys
from pathlib import Path

import pytest

from restitution.errors import CaseError
from restitution.numerics import memory
from tolerance import approx


@pytest.mark.parametrize(
    ("groups", "file", "text", "limit"),
    [
        ("0::/a/b\n", "a/memory.max", "3000000000\n", 3e9),
        ("0::/a/b\n", "a/b/memory.max", "max\n", math.inf),
        ("0::/not/there\n", "memory.max", "2000\n", 2000),
        ("4:memory:/a/b\n", "memory/a/b/memory.limit_in_bytes", "7000\n", 7000),
        ("5:cpu,memory:/a/b\n", "memory/memory.limit_in_bytes", "8000\n", 8000),
        ("4:memory:/a\n", "memory/memory.limit_in_bytes", "9223372036854771712\n", math.inf),
        ("nonsense\n", "memory.max", "5\n", math.inf),
    ],
)
def test_limits_of_control_groups(tmp_path, monkeypatch, groups, file, text, limit):
    monkeypatch.setattr(memory, "_GROUPS", tmp_path / "fs")
    (tmp_path / "fs" / file).parent.mkdir(parents=True)
    (tmp_path / "fs" / file).write_text(text)
    (tmp_path / "groups").write_text(groups)
    assert memory._of_control_groups(str(tmp_path / "groups")) == limit


def test_a_system_without_control_groups_has_no_limit(tmp_path):
    assert memory._of_control_groups(str(tmp_path / "absent")) == math.inf


def test_the_least_limit_counts(monkeypatch):
    monkeypatch.setattr(memory, "_of_machine", lambda: 5e9)
    monkeypatch.setattr(memory, "_of_control_groups", lambda: 3e9)
    monkeypatch.setattr(memory, "_of_address_space", lambda: 4e9)
    assert memory.available() == 3e9
    memory.require(2.9e9, "this", "use less")
    with pytest.raises(
        CaseError, match=r"^this take about 3.1 GB of memory, but only 3 GB is available"
    ):
        memory.require(3.1e9, "this", "use less")


@pytest.mark.skipif(sys.platform != "linux", reason="ulimit -v is kept on Linux alone")
def test_the_limit_of_addresses_counts():
    code = "from restitution.numerics.memory import available; print(available())"
    limited = f"ulimit -v 1500000; exec {sys.executable} -c '{code}'"
    done = subprocess.run(["bash", "-c", limited], capture_output=True, text=True, check=True)
    assert 0.5e9 < float(done.stdout) < 1.6e9


@pytest.mark.skipif(sys.platform != "linux", reason="sizes are those of Linux")
def test_addresses_that_are_only_reserved_do_not_count_as_free(monkeypatch):
    monkeypatch.setattr("resource.getrlimit", lambda _: (10**12, 10**12))
    status = Path("/proc/self/status").read_text()
    size, resident = (
        1024 * int(re.search(rf"{name}:\s+(\d+) kB", status)[1]) for name in ("VmSize", "VmRSS")
    )
    assert 10**12 - memory._of_address_space() == approx(size - resident, abs=1e7)


@pytest.mark.parametrize("error", [AttributeError, ValueError, OSError])
def test_a_system_that_does_not_say_its_memory_has_no_limit(monkeypatch, error):
    def fail(_):
        raise error

    monkeypatch.setattr("os.sysconf", fail)
    assert memory._of_machine() == math.inf


def test_sizes_in_words():
    assert [memory.in_words(size) for size in (1e9, 999e6, 2.345e10)] == [
        "1 GB",
        "999 MB",
        "23.4 GB",
    ]
