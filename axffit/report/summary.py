"""The sentence on top of a page."""

from collections.abc import Mapping, Sequence
from typing import Any

from axffit.report.measured_view import sentence
from axffit.report.numbers import percent


def summarize(sections: Sequence[Mapping[str, Any]]) -> tuple[str, bool | None]:
    """What a reader must know if nothing else is read, and whether all verdicts are within (None without a verdict)."""
    verdicts = [s["result"] for s in sections if s["kind"] == "verify"]
    fits = [s for s in sections if s["kind"] == "fit"]
    comparisons = [s for s in sections if s["kind"] == "compare"]
    sentences = []
    if verdicts:
        sentences.append(_verdicts(verdicts))
    if fits:
        sentences.append(_fits(fits))
    sentences += [_comparison(section) for section in comparisons]
    sentences += [f"{s['title']}: {sentence(s['result'])}" for s in sections if s["kind"] == "measured"]
    within = all(v["within"] for v in verdicts) if verdicts else None
    return " ".join(sentences), within


def engines(verdict: Mapping[str, Any]) -> str:
    """For which engine a verdict is; both where one packs and another reads."""
    target, packer = verdict["target"], verdict["packed_for"]
    return f"verified for {target}" if packer == target else f"packed for {packer}, read by {target}"


def _counted(number: int, one: str) -> str:
    words = ("No", "One", "Two", "Three", "Four", "Five", "Six", "Seven", "Eight", "Nine")
    return f"{words[number] if number < len(words) else number} {one}{'' if number == 1 else 's'}"


def _listed(names: Sequence[str]) -> str:
    return names[0] if len(names) == 1 else ", ".join(names[:-1]) + " and " + names[-1]


def _verdicts(verdicts: Sequence[Mapping[str, Any]]) -> str:
    ways = _listed(sorted({engines(v) for v in verdicts}))
    textures = sum(len(v["textures"]) for v in verdicts)
    opening = f"{_counted(len(verdicts), 'material')} {ways} ({textures} textures): "
    outside = [v for v in verdicts if not v["within"]]
    if not outside:
        return opening + "every error is within its tolerance."
    names = _listed([f"{v['material']['name'] or v['material']['id']} ({len(v['failures'])})" for v in outside])
    return f"{opening}outside tolerance: {names}."


def _fits(fits: Sequence[Mapping[str, Any]]) -> str:
    results = [(s["title"], s["result"]) for s in fits]
    failed = [title for title, result in results if not result["ok"]]
    metrics = [r["metrics"] for _, r in results if r["metrics"] is not None]
    errors = [m["relative_cosine_rms"] for m in metrics if m["relative_cosine_rms"] is not None]
    sentence = f"{_counted(len(fits), 'sampled BRDF')} fitted"
    if errors:
        ends = [percent(x, 2) for x in (min(errors), max(errors))]
        sentence += f", relative cosine RMS error {ends[0] if len(errors) == 1 else ' to '.join(ends)}"
    return sentence + (f"; not converged: {_listed(failed)}." if failed else ".")


def _comparison(section: Mapping[str, Any]) -> str:
    error = section["result"]["metrics"]["relative_cosine_rms"]
    if error is None:
        return f"{section['title']}: {section['result']['sentence']}"
    return f"{section['title']}: relative cosine RMS error {percent(error, 2)}, without fitting."
