"""What a case's reference.toml says (scripts/regress has its form), and how a run compares with it."""
import math
import tomllib

KINDS = ("theory", "experiment", "pinned")
SAME_PHYSICS = ("output.", "contacts.backend=", "run.balance")  # keys that a reference does not depend on


class Fault(Exception):
    """What is wrong with a reference.toml."""


def references(case, short=False):
    """Returns the quantities to compare, and the settings of the run they belong to."""
    file = case / "reference.toml"
    data = tomllib.loads(file.read_text()) if file.exists() else {}
    settings = []
    if short and "short" in data:
        data = data["short"]
        settings = [f"run.steps={data['steps']}", *data.get("set", [])]
    listed = data.get("quantity", [])
    if not listed:
        raise Fault(f"{file}: the {'short' if short else 'full'} form of {case.name} compares nothing; "
                    f"add a [[{'short.' if settings else ''}quantity]]")
    for quantity in listed:
        for key in ("name", "value", "tolerance", "kind", "source"):
            if key not in quantity:
                raise Fault(f"{file}: a [[quantity]] has no {key}")
        if quantity["kind"] not in KINDS:
            raise Fault(f"{file}: kind is {quantity['kind']!r}; it must be one of {', '.join(KINDS)}")
    return listed, settings


def is_known(value):
    return isinstance(value, (int, float)) and math.isfinite(value)


def compared(quantity, quantities):
    """Returns [found, reference, tolerance, deviation] as text, and whether the quantity is within its tolerance.

    quantities: those of the report."""
    found, value, tolerance = quantities.get(quantity["name"]), quantity["value"], quantity["tolerance"]
    if isinstance(value, str):
        name, value = value, quantities.get(value)
        if not is_known(value):
            return [f"{found:.6g}" if is_known(found) else "missing", f"{name} is missing", f"{tolerance:.2g}", "-"], False
    allowed = tolerance * abs(value) if quantity.get("relative", False) else tolerance
    good = is_known(found) and abs(found - value) <= allowed
    if not is_known(found):
        return ["missing", f"{value:g}", f"{allowed:.2g}", "-"], False
    deviation = f"{100 * (found - value) / abs(value):+.2f} %" if value else f"{found - value:+.2g}"
    return [f"{found:.6g}", f"{value:g}", f"{allowed:.2g}", deviation], good


def belongs(report):
    """Says whether a run is the one that the full form compares: ended by itself, with the case's own physics and length."""
    return report["exit_reason"] in ("completed", "steady") and all(
        override.startswith(SAME_PHYSICS) for override in report["overrides"])
