import pytest


@pytest.fixture(params=[1, 2, 3, 40])
def threads(request):
    """So many threads for what is worth them; then as many as before."""
    loops = pytest.importorskip("restitution.numerics.loops", reason="built without a compiler")
    before = loops.threads_for(10**9)
    loops.use_threads(request.param)
    yield request.param
    loops.use_threads(before)
