"""Filters of a dataset, looked at before libhdf5 runs them over untrusted chunks."""

from collections.abc import Mapping

import h5py
import h5py.h5d
import h5py.h5z

from ..errors import InputError

FILTERS: Mapping[int, str] = {
    h5py.h5z.FILTER_DEFLATE: "deflate",
    h5py.h5z.FILTER_SHUFFLE: "shuffle",
    h5py.h5z.FILTER_FLETCHER32: "fletcher32",
    32000: "lzf",
}
"""The filters that are read; any other could also make libhdf5 load a plug-in from a folder."""

_CHECKSUM_BYTES = 4


def check_filters(dataset: h5py.h5d.DatasetID) -> None:
    """Refuse a dataset whose filters are not read, or would be run where they crash.

    libhdf5's fletcher32 takes 4 bytes off a chunk without looking whether it has so many, and then reads on to the
    end of the memory (seen in HDF5 2.0.0). So it must be the last filter, where it meets the chunk as it is stored.

    Raises:
        InputError: a filter is not one of `FILTERS`, or a chunk is too short for its checksum.
    """
    properties = dataset.get_create_plist()
    if properties.get_layout() != h5py.h5d.CHUNKED:
        return
    found = [properties.get_filter(k)[0] for k in range(properties.get_nfilters())]
    for number in found:
        if number not in FILTERS:
            raise InputError(f"its filter {number} is not read; those that are: {', '.join(FILTERS.values())}")
    if h5py.h5z.FILTER_FLETCHER32 not in found:
        return
    if found.index(h5py.h5z.FILTER_FLETCHER32) != len(found) - 1:
        raise InputError("its filter fletcher32 is not the last one; store it as h5py does")

    def is_short(chunk: h5py.h5d.StoreInfo) -> bool | None:
        return True if chunk.size <= _CHECKSUM_BYTES else None

    if dataset.chunk_iter(is_short):
        raise InputError("a chunk is too short for its checksum")
