"""The measurements: a line of JSON a run in one file, added the moment the run ends, so that an interrupted
session goes on where it stopped. A result counts for one case text, one program, and one way of measuring."""
import hashlib
import inspect
import json


def digest(*texts):
    h = hashlib.sha256()
    for text in texts:
        data = text if isinstance(text, bytes) else str(text).encode()
        h.update(str(len(data)).encode() + b":" + data)
    return h.hexdigest()[:20]


def fingerprint(module, run, program):
    """Returns what a result hangs on. Of the module only the text of measure: helpers that change need --rerun."""
    files = [part for item in sorted(run.files.items()) for part in item]
    return digest(module.__name__, run.key, run.case, run.ranks, inspect.getsource(module.measure), program, *files)


class Results:
    def __init__(self, path):
        self.path = path
        self.by_fingerprint = {}
        if path.exists():
            for line in path.read_text().splitlines():
                try:
                    entry = json.loads(line)
                except json.JSONDecodeError:  # the session was killed while it wrote
                    continue
                self.by_fingerprint[entry["fingerprint"]] = entry

    def get(self, fingerprint):
        return self.by_fingerprint.get(fingerprint)

    def add(self, entry):
        self.by_fingerprint[entry["fingerprint"]] = entry
        self.path.parent.mkdir(parents=True, exist_ok=True)
        with open(self.path, "a+b") as stream:
            if stream.seek(0, 2) and not ends_a_line(stream):
                stream.write(b"\n")
            stream.write((json.dumps(entry) + "\n").encode())


def ends_a_line(stream):
    stream.seek(-1, 2)
    return stream.read(1) == b"\n"
