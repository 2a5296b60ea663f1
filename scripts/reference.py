"""The content of a case's reference.toml (scripts/regress has its form), and its comparison with a run."""
import math
import tomllib

import verification

KINDS = ("theory", "experiment", "pinned")
SAME_PHYSICS = ("output.", "contacts.backend=", "run.balance")  # keys that a reference does not depend on
KEYS = {"name", "computed", "value", "tolerance", "relative", "between", "kind", "source", "doi", "uncertainty", "note"}
WITH_PREFIXES = ("m", "m/s", "s", "N", "N m", "J", "W")  # units of which there are thousandths and millionths


class Fault(Exception):
    """A fault in a reference.toml."""


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
        check(quantity, file)
    return listed, settings


def check(quantity, file):
    """Raises Fault for a quantity that cannot be compared."""
    of = f"{file}: [[quantity]] {quantity.get('name', '')!r}"
    for key in ("name", "kind", "source"):
        if key not in quantity:
            raise Fault(f"{file}: a [[quantity]] has no {key}")
    if unknown := sorted(set(quantity) - KEYS):
        raise Fault(f"{of} has {unknown[0]!r}; it may have {', '.join(sorted(KEYS))}")
    if quantity["kind"] not in KINDS:
        raise Fault(f"{file}: kind is {quantity['kind']!r}; it must be one of {', '.join(KINDS)}")
    if "computed" in quantity and not hasattr(verification, quantity["computed"]):
        raise Fault(f"{of}: computed is {quantity['computed']!r}; it must be a function of scripts/verification.py")
    if "between" not in quantity:
        for key in ("value", "tolerance"):
            if key not in quantity:
                raise Fault(f"{of} has no {key}; give value and tolerance, or between = [a, b]")
        return
    for key in ("value", "tolerance", "relative"):
        if key in quantity:
            raise Fault(f"{of} has both between and {key}; give value and tolerance, or between = [a, b]")
    ends = quantity["between"]
    if not (isinstance(ends, list) and len(ends) == 2 and all(map(is_known, ends)) and ends[0] < ends[1]):
        raise Fault(f"{of}: between is {ends}; it must be two numbers, the lower one first")


def is_known(value):
    return isinstance(value, (int, float)) and math.isfinite(value)


def target(quantity, quantities):
    """Returns the value and the tolerance, in the quantity's unit; None for a value that is another quantity's and missing."""
    value, tolerance = quantity["value"], quantity["tolerance"]
    if isinstance(value, str):
        value = quantities.get(value)
    if not is_known(value):
        return None, tolerance
    return value, tolerance * abs(value) if quantity.get("relative", False) else tolerance


def compared(quantity, quantities):
    """Returns [found, reference, tolerance, deviation] as text, and whether the quantity is within its bounds.

    quantities: those of the report."""
    found = quantities.get(quantity["name"])
    seen = f"{found:.6g}" if is_known(found) else "missing"
    if "between" in quantity:
        low, high = quantity["between"]
        good = is_known(found) and low <= found <= high
        return [seen, f"{low:g} to {high:g}", "-", "-" if not is_known(found) else "inside" if good else "outside"], good
    value, allowed = target(quantity, quantities)
    if value is None:
        return [seen, f"{quantity['value']} is missing", f"{allowed:.2g}", "-"], False
    if not is_known(found):
        return [seen, f"{value:g}", f"{allowed:.2g}", "-"], False
    deviation = f"{100 * (found - value) / abs(value):+.2f} %" if value else f"{found - value:+.2g}"
    return [seen, f"{value:g}", f"{allowed:.2g}", deviation], abs(found - value) <= allowed


def scaled(numbers, unit):
    """Returns numbers, None among them, and the unit or a part of it in which the largest is easy to read."""
    largest = max((abs(x) for x in numbers if is_known(x)), default=0)
    if unit in WITH_PREFIXES:
        for part, prefix in ((1e-6, "µ"), (1e-3, "m")):
            if largest and largest < 100 * part:
                return [x / part if is_known(x) else x for x in numbers], " " + prefix + unit
    return numbers, " " + unit if unit else ""


def told(quantity, report):
    """Returns a line that says how a quantity of a report compares, in a unit that its numbers are easy to read in; with the note of the
    reference where it is only loosely met."""
    name, quantities = quantity["name"], report.get("quantities", {})
    unit = report.get("quantity_types", {}).get(name, {}).get("unit", "")
    cells, good = compared(quantity, quantities)
    found = quantities.get(name)
    if "between" in quantity:
        (found, low, high), unit = scaled([found, *quantity["between"]], unit)
        seen = f"{found:.3g}{unit}" if is_known(found) else "missing"
        return f"{name}: {seen}, between {low:g} and {high:g}{unit}: {'inside' if good else 'outside'}"
    value, allowed = target(quantity, quantities)
    if value is None or not is_known(found):
        return f"{name}: {cells[0]}, {quantity['kind']} {cells[1]}: deviates"
    loose = abs(found - value) > min(allowed / 2, 0.05 * abs(value) or allowed)
    note = f" ({quantity['note']})" if loose and "note" in quantity else ""
    (found, value, allowed), unit = scaled([found, value, allowed], unit)
    off = f" ({cells[3]})" if value else ""
    return f"{name}: {found:.4g}{unit}, {quantity['kind']} {value:.4g} ± {allowed:.2g}{unit}{off}: {'ok' if good else 'deviates'}{note}"


def belongs(report):
    """Says whether a run is the one that the full form compares: ended by itself, with the case's own physics and length."""
    return report["exit_reason"] in ("completed", "steady") and all(
        override.startswith(SAME_PHYSICS) for override in report["overrides"])


def add_computed(listed, run):
    """Adds to a run's report the listed quantities that verification.py computes from its files, if it has them."""
    for quantity in listed:
        try:
            if "computed" in quantity:
                run.report["quantities"][quantity["name"]] = getattr(verification, quantity["computed"])(run)
        except (FileNotFoundError, IndexError):
            pass


def judged_by(case, run):
    """Returns the quantities by which the full form compares a run; none of another, or where the reference is at fault."""
    try:
        listed = references(case)[0] if belongs(run.report) else []
    except (Fault, OSError, tomllib.TOMLDecodeError):
        return []
    add_computed(listed, run)
    return listed


def comparison(case, run):
    """Returns the lines of told of a run that the full form compares."""
    return [told(quantity, run.report) for quantity in judged_by(case, run)]
