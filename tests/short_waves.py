"""A surface whose short waves go into patches on cells of 0.4 µm."""

SHORT_WAVES = {
    "kind": "self-affine",
    "rms": "15 nm",
    "hurst": 0.8,
    "rolloff": "2 um",
    "shortest": "0.4 um",
    "seed": 1,
    "below_grid": "patch",
    "split": "0.8 um",
}
