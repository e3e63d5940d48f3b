# SPDX-FileCopyrightText: 2026 the psfm authors
# SPDX-License-Identifier: BSD-3-Clause
"""Work that is kept: a folder, the settings that it was made with, and what was noted when it was done."""
import hashlib
import json
import shutil
from pathlib import Path

from console import Failed

BEGUN = "begun.json"
DONE = "done.json"


def digest_of_file(file):
    """A short name of a file's content."""
    content = hashlib.blake2b(digest_size=12)
    with Path(file).open("rb") as stream:
        while block := stream.read(1 << 20):
            content.update(block)
    return content.hexdigest()


def digest_of_names(names):
    return hashlib.blake2b("\n".join(names).encode(errors="surrogateescape"), digest_size=12).hexdigest()


class Kept:
    """A folder of work. Its settings are compared as JSON: other settings, other work."""

    def __init__(self, folder, settings):
        self.folder = Path(folder)
        self.settings = json.loads(json.dumps(settings))

    def _read(self, name):
        try:
            return json.loads((self.folder / name).read_text())
        except (OSError, json.JSONDecodeError):
            return None

    def record(self):
        """What was noted at the end of work with these settings; None when it is not done."""
        return self._read(DONE) if self.is_begun() else None

    def is_begun(self):
        return self._read(BEGUN) == self.settings

    def begin(self):
        """An empty folder for these settings. Only what an experiment wrote is ever removed."""
        if self.folder.exists():
            if not (self.folder / BEGUN).exists() and any(self.folder.iterdir()):
                raise Failed(f"{self.folder} holds files that no experiment wrote; choose another --work")
            shutil.rmtree(self.folder)
        self.folder.mkdir(parents=True)
        (self.folder / BEGUN).write_text(json.dumps(self.settings, indent=1) + "\n")

    def finish(self, record):
        (self.folder / DONE).write_text(json.dumps(record, indent=1) + "\n")
        return record
