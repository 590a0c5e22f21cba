"""Files of results that are damaged, altered, older or of another model."""

from __future__ import annotations

import json
import os
import zipfile
from zlib import crc32

import numpy as np
import pytest

import skfem_contact as sc
from tests.tools.scenes import block_on_base, halves


@pytest.fixture
def saved(tmp_path):
    _, forms, load, fixed = block_on_base()
    file = tmp_path / "good.npz"
    sc.Model(forms, fixed).run([sc.Stage("weight", load)], progress=False).save(file)
    return file, forms


@pytest.mark.parametrize(
    "content", [lambda d: b"", lambda d: d[: len(d) // 2], lambda d: b"hello", lambda d: d[:-900]]
)
def test_broken_files(saved, content):
    file, forms = saved
    file.write_bytes(content(file.read_bytes()))
    with pytest.raises(ValueError, match=r"good.npz cannot be read as a result"):
        sc.load_result(file, forms)


@pytest.mark.parametrize("key", ["0/x", "0/bodies/stress", "0/joint/status"])
def test_altered_files(saved, key):
    """A number that is not what was written, wherever."""
    file, forms = saved
    with np.load(file) as data:
        arrays = {name: data[name].copy() for name in data.files}
    arrays[key].flat[0] += 1
    np.savez_compressed(file, **arrays)
    with pytest.raises(
        ValueError, match=rf"good.npz cannot be read .*\['{key}'\] are not what was written"
    ):
        sc.load_result(file, forms)


@pytest.mark.parametrize(
    ("key", "value"),
    [("0/x", np.nan), ("0/load", np.inf), ("0/bodies/stress", np.nan), ("0/joint/status", 7)],
)
def test_altered_numbers_with_their_checksum(saved, key, value):
    """Values are checked, not only whether they are those that were written."""
    file, forms = saved
    with np.load(file) as data:
        arrays = {name: data[name].copy() for name in data.files}
    head = json.loads(str(arrays["head"]))
    arrays[key].flat[0] = value
    head["sums"][key] = crc32(arrays[key].tobytes())
    np.savez_compressed(file, **{**arrays, "head": np.array(json.dumps(head))})
    with pytest.raises(ValueError, match=rf"good.npz cannot be read .*'{key.split('/')[-1]}' of "):
        sc.load_result(file, forms)


def test_shorter_displacements_with_their_checksum(saved):
    file, forms = saved
    with np.load(file) as data:
        arrays = {name: data[name].copy() for name in data.files}
    head = json.loads(str(arrays["head"]))
    arrays["0/x"] = arrays["0/x"][:-1]
    head["sums"]["0/x"] = crc32(arrays["0/x"].tobytes())
    np.savez_compressed(file, **{**arrays, "head": np.array(json.dumps(head))})
    with pytest.raises(
        ValueError, match=r"good.npz cannot be read .*displacements and loads of shapes"
    ):
        sc.load_result(file, forms)


def test_flipped_bits(saved):
    """Whatever the damage breaks, the error names the file; a bit that nothing reads may be
    another.
    """
    file, forms = saved
    written, rng = file.read_bytes(), np.random.default_rng(1)
    refused = 0
    for at, bit in zip(
        rng.integers(len(written), size=100), rng.integers(8, size=100), strict=True
    ):
        flipped = bytearray(written)
        flipped[at] ^= 1 << int(bit)
        file.write_bytes(flipped)
        try:
            sc.load_result(file, forms)
        except ValueError as error:
            assert "good.npz" in str(error)
            refused += 1
    assert refused > 50


def test_size_beyond_the_memory(saved, tmp_path):
    file, forms = saved
    with zipfile.ZipFile(file) as old, zipfile.ZipFile(tmp_path / "huge.npz", "w") as new:
        for name in old.namelist():
            content = old.read(name)
            if name == "0/x.npy":
                start, end = content.index(b"(") + 1, content.index(b",)")
                shape = str(2**50).encode()
                content = (
                    content[:start]
                    + shape
                    + content[end:].replace(b" " * (len(shape) - end + start), b"", 1)
                )
            new.writestr(name, content)
    with pytest.raises(ValueError, match=r"huge.npz cannot be read as a result"):
        sc.load_result(tmp_path / "huge.npz", forms)


@pytest.mark.skipif(os.name == "nt", reason="modes and links are those of POSIX")
def test_saving_keeps_mode_and_link(saved, tmp_path):
    file, forms = saved
    other = tmp_path / "new.npz"
    other.touch()
    usual = other.stat().st_mode
    result = sc.load_result(file, forms)
    assert file.stat().st_mode == usual
    file.chmod(0o640)
    link = tmp_path / "link.npz"
    link.symlink_to(file)
    result.save(link)
    assert link.is_symlink()
    assert file.stat().st_mode & 0o777 == 0o640
    assert sorted(path.name for path in tmp_path.iterdir()) == ["good.npz", "link.npz", "new.npz"]


@pytest.mark.parametrize(("shift", "stretch"), [(100.0, 1.0), (0.0, 2.0), (0.0, 1.0 + 2e-8)])
def test_another_mesh_of_the_same_size(saved, shift, stretch):
    with pytest.raises(ValueError, match="'bodies' has another mesh"):
        sc.load_result(saved[0], block_on_base(shift, stretch)[1])


def test_an_older_layout(saved):
    """It is refused with the version that wrote it."""
    file, forms = saved
    np.savez_compressed(file, head=np.array('[{"name": "weight"}]'))
    with pytest.raises(
        ValueError, match=r"version 0\.1\.0 of this library wrote it, with another layout"
    ):
        sc.load_result(file, forms)


def test_a_file_is_replaced_when_the_new_one_is_complete(saved, monkeypatch):
    file, forms = saved
    before, result = file.read_bytes(), sc.load_result(file, forms)

    def full(*args, **kwargs):
        raise OSError("no space left on device")

    monkeypatch.setattr(np, "savez_compressed", full)
    with pytest.raises(OSError, match="no space"):
        result.save(file)
    assert file.read_bytes() == before and [f.name for f in file.parent.iterdir()] == ["good.npz"]


ELASTIC = sc.LinearElastic(E=1e4, nu=0.3)


def test_file_of_elements_in_another_order(tmp_path):
    """States follow the order of the materials: a file is refused where another one would exchange
    them.
    """
    basis = halves()

    def block_on_base(names):
        solid = sc.SolidForm(basis, dict.fromkeys(names, ELASTIC), unit_weight=20.0)
        return sc.Model({"soil": solid}, basis.get_dofs({"l:bottom", "r:bottom"}).all())

    block_on_base("lr").run([sc.Stage("weight")]).save(tmp_path / "weight.npz")
    assert sc.load_result(tmp_path / "weight.npz", block_on_base("lr"))["weight"].residual < 1e-12
    with pytest.raises(
        ValueError,
        match="'soil' has another mesh, or another order of the elements, which follow its",
    ):
        sc.load_result(tmp_path / "weight.npz", block_on_base("rl"))
