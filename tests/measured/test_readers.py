"""Laws that every reader of the table obeys: a new one is one line in `makers.MAKERS`."""

import numpy as np
import pytest

from axffit import measured
from axffit.errors import InputError
from tests.measured.makers import MAKERS

TEXT = {".csv", ".astm", ".alta", ".zemax"}


@pytest.fixture(scope="module", params=MAKERS)
def made(request, tmp_path_factory):
    path = tmp_path_factory.mktemp("made") / request.param
    MAKERS[request.param](path)
    return path


def test_every_format_of_the_table_is_made_here(tmp_path):
    """All but neural encodings, which have tests of their own."""
    for name, make in MAKERS.items():
        make(tmp_path / name)
    found = {measured.format_of(tmp_path / name) for name in MAKERS}
    assert found == {form for form in measured.FORMATS if not form.named}


def test_it_is_read_and_says_where_it_comes_from(made):
    samples = measured.read(made)
    assert samples.valid.any()
    assert samples.weights.sum() == pytest.approx(1.0)
    assert np.isfinite(samples.values[samples.valid]).all()
    assert samples.provenance["file"].startswith(made.name)
    assert {"format", "cosine"} <= samples.provenance.keys()
    assert samples.name


def test_its_content_alone_tells_the_format(made, tmp_path):
    other = tmp_path / "unnamed.data"
    other.write_bytes(made.read_bytes())
    assert measured.format_of(other) == measured.format_of(made)


def is_refused(path, data):
    path.write_bytes(data)
    with pytest.raises(InputError) as caught:
        measured.read(path)
    message = str(caught.value)
    assert str(path) in message
    assert "\n" not in message


def test_a_truncated_file_is_refused(made, tmp_path):
    data = made.read_bytes().rstrip(b"\n")
    # Within the last row of text: a number cut short is still a number.
    separators = (
        [data.rfind(separator) for separator in (b",", b"  ", b"\t")] if made.suffix in TEXT else [len(data) - 7]
    )
    last = data[: max(separators)]
    for cut in (last, data[:9]):
        is_refused(tmp_path / made.name, cut)


def test_swapped_bytes_are_refused(made, tmp_path):
    data = made.read_bytes()
    for size in (2,) if made.suffix in TEXT else (4, 8):
        whole = np.frombuffer(data[: len(data) // size * size], f">u{size}")
        is_refused(tmp_path / made.name, whole.astype(f"<u{size}").tobytes() + data[whole.nbytes :])


def test_another_header_is_refused(made, tmp_path):
    data = made.read_bytes()
    words = data.replace(b"a", b"z").replace(b"A", b"Z")
    is_refused(tmp_path / made.name, words if made.suffix in TEXT else b"Z" * 8 + data[8:])
    is_refused(tmp_path / made.name, b"")


def test_a_missing_file_is_refused(tmp_path):
    for name in MAKERS:
        with pytest.raises(InputError, match="cannot be read"):
            measured.read(tmp_path / name)
