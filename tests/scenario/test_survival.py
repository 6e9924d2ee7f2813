"""One flipped bit anywhere in the static state: nothing crashes or hangs, and fewer than one in a thousand is believed in error."""

import survival


def test_bit_flips(tmp_path):
    code, table, silent, crashed = survival.flips(tmp_path, 20000, seed=2)
    print(table)
    assert code == 0 and crashed == 0 and silent < survival.MOST_SILENT_PERCENT


def test_the_count_is_of_real_flips(tmp_path):
    """What flips in the decoders' buffers and what flips in the filter does not come to the same."""
    _, table, _, _ = survival.flips(tmp_path, 3000, seed=3)
    rows = {r.split("|")[1].strip(): [int(x) for x in r.split("|")[2:-1]] for r in table.splitlines() if r.startswith("| ") and "member" not in r}
    bytes_, masked, recovered, stopped, silent, crashed = rows["**all**"]
    assert masked + recovered + stopped + silent + crashed == 3000
    assert recovered + stopped > 30 and rows["nav.ud"][2] > 0
    assert sum(r[0] for name, r in rows.items() if name != "**all**") == bytes_
