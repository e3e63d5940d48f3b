#!/usr/bin/env python3
# SPDX-FileCopyrightText: 2026 the psfm authors
# SPDX-License-Identifier: BSD-3-Clause
"""Makes psfm's packages for a release of Debian or Ubuntu and uses them on clean roots of it, as someone would who has
nothing but that release: apt install, photographs to a data set, a photograph localised; a program that links the
libraries.

usage: package_test.py BUILD RELEASE [--dev]     (RELEASE: debian12, debian13 or ubuntu24.04; --dev: libpsfm-dev, too,
                                                  which takes a gigabyte)

The release that the test runs on is built for here, others in a root of theirs; what was compiled and downloaded stays
in build/package. Exit code 77: mmdebstrap, the release's archive or its key is not there. Ubuntu's key comes with the
package ubuntu-keyring, or PSFM_UBUNTU_KEYRING names the file. PSFM_MIRROR: another archive than mmdebstrap's own.
"""
import json
import os
import shutil
import subprocess
import sys
import tempfile
from pathlib import Path

ROOT = Path(__file__).resolve().parents[3]
MIRROR = [os.environ["PSFM_MIRROR"]] if "PSFM_MIRROR" in os.environ else []
UBUNTU_KEYRING = Path(os.environ.get("PSFM_UBUNTU_KEYRING", "/usr/share/keyrings/ubuntu-archive-keyring.gpg"))
# The suite, and what mmdebstrap is told of it.
RELEASES = {"debian12": ("bookworm", []),
            "debian13": ("trixie", []),
            "ubuntu24.04": ("noble", ["--components=main,universe", f"--keyring={UBUNTU_KEYRING}"])}
SKIPPED = 77

# What a user does on a clean system. Everything else that is in there has come by apt as a dependency of psfm.
USE = r"""
set -eux
cd /root
apt-get install --yes ./psfm_*.deb
psfm --version
psfm doctor --folder /root
psfm run photographs --session session --threads 2 --dataset one_command
psfm export --session session --format dataset --output train --reduced 2
psfm export --session session --format gltf --output gltf
psfm localise --session session photographs/*0.jpg --json > localised.json
psfm check --session session
psfm check --session brought
psfm run photographs --session brought --threads 2
psfm check --session brought
psfm view --session session --output model.html
psfm report --session session --output report.html
gzip -dc /usr/share/man/man1/psfm-export.1.gz > manual.txt
bash -c 'source /usr/share/bash-completion/completions/psfm
         COMP_WORDS=(psfm exp); COMP_CWORD=1; _psfm; echo "${COMPREPLY[@]}"' > completed.txt
getent passwd psfm > user.txt
su -s /bin/sh psfm -c 'psfm serve --session /var/lib/psfm/session --add-user Ada --role owner' >> user.txt
test -f /usr/lib/systemd/system/psfm.service
apt-get remove --yes psfm
test ! -e /usr/bin/psfm
"""
LINK = r"""
set -eux
cd /root
apt-get install --yes --no-install-recommends ./libpsfm-dev_*.deb g++ cmake ninja-build
cmake -S consumer -B built -G Ninja
cmake --build built
built/psfm-consumer
"""


def run(*words, **options):
    print("+", *words, flush=True)
    subprocess.run([str(word) for word in words], check=True, **options)


def running_release():
    lines = Path("/etc/os-release").read_text(encoding="utf-8").splitlines()
    values = dict(line.split("=", 1) for line in lines if "=" in line)
    return values.get("ID", "").strip('"') + values.get("VERSION_ID", "").strip('"')


class Release:
    def __init__(self, name):
        self.name = name
        self.suite, self.options = RELEASES[name]
        self.kept = ROOT / "build/package"
        self.packages = self.kept / name

    def what_is_missing(self):
        """In words; None: roots of the release can be made here."""
        if shutil.which("mmdebstrap") is None:
            return "mmdebstrap is not installed: tools/install-packages --package"
        if self.name.startswith("ubuntu") and not UBUNTU_KEYRING.exists():
            return f"{UBUNTU_KEYRING} is not there: it comes with the package ubuntu-keyring"
        tried = subprocess.run(["mmdebstrap", "--simulate", "--variant=essential", *self.options, self.suite, "/dev/null",
                                *MIRROR], capture_output=True, text=True, check=False)
        return None if tried.returncode == 0 else f"no root of {self.name} can be made:\n{tried.stderr}"

    def in_root(self, script, hooks_in, hooks_out, include=()):
        """Runs a script in a new root of the release, with files taken in before and out after it, even if it fails."""
        archives = self.kept / f"archives-{self.name}"
        archives.mkdir(parents=True, exist_ok=True)
        with tempfile.NamedTemporaryFile("w", suffix=".sh") as file:
            file.write(script)
            file.flush()
            words = ["mmdebstrap", "--variant=apt", "--format=null",
                     # Packages are downloaded once.
                     "--skip=essential/unlink,cleanup/apt/cache",
                     '--setup-hook=mkdir -p "$1/var/cache/apt/archives"',
                     f"--setup-hook=sync-in {archives} /var/cache/apt/archives",
                     *[f"--customize-hook={hook}" for hook in hooks_in],
                     f"--customize-hook=upload {file.name} /root/script.sh",
                     '--customize-hook=chroot "$1" env HOME=/root LC_ALL=C.UTF-8 DEBIAN_FRONTEND=noninteractive bash '
                     '/root/script.sh || touch "$1/root/failed"',
                     *[f"--customize-hook={hook}" for hook in hooks_out],
                     f"--customize-hook=sync-out /var/cache/apt/archives {archives}",
                     '--customize-hook=test ! -e "$1/root/failed"',
                     '--customize-hook=rm -f "$1"/var/cache/apt/archives/*.deb']
            if include:
                words.append("--include=" + ",".join(include))
            run(*words, *self.options, self.suite, "/dev/null", *MIRROR)

    def make(self):
        if self.name == running_release():
            run(ROOT / "tools/package/make-packages", self.packages)
            return
        packages = subprocess.run([ROOT / "tools/install-packages", "--list"], capture_output=True, text=True, check=True)
        ccache = self.kept / f"ccache-{self.name}"
        ccache.mkdir(parents=True, exist_ok=True)
        self.packages.mkdir(parents=True, exist_ok=True)
        fetched = ROOT / "build/npm"  # three.js, so that the root need not reach npm's registry
        fetched.mkdir(parents=True, exist_ok=True)
        commit_time = subprocess.run(["git", "-C", ROOT, "log", "-1", "--format=%ct"], capture_output=True, text=True,
                                     check=False).stdout.strip() or "0"
        with tempfile.NamedTemporaryFile(suffix=".tar") as sources:
            listed = subprocess.run(["git", "-C", ROOT, "ls-files", "-z", "--cached", "--others", "--exclude-standard"],
                                    capture_output=True, check=True).stdout
            run("tar", "-C", ROOT, "-c", "--null", "-T", "-", "-f", sources.name, input=listed)
            jobs = os.environ.get("PSFM_JOBS", "")
            self.in_root(f"""set -eux
export CCACHE_DIR=/ccache CCACHE_BASEDIR=/source CCACHE_NOHASHDIR=1 SOURCE_DATE_EPOCH={commit_time}
export PSFM_JOBS={jobs or '$(nproc)'}
cd /source && tools/package/make-packages /packages
""", ['mkdir -p "$1/source/build/npm" "$1/packages" "$1/ccache"', f"tar-in {sources.name} /source",
      f"sync-in {fetched} /source/build/npm", f"sync-in {ccache} /ccache"],
                         [f"sync-out /ccache {ccache}", f"sync-out /packages {self.packages}"],
                         packages.stdout.split() + ["git", "ca-certificates"])

    def package(self, name):
        found = sorted(self.packages.glob(f"{name}_*_*.deb"), key=lambda file: file.stat().st_mtime)
        assert found, f"no package {name} in {self.packages}"
        return found[-1]


def use(release, psfm, photographs, folder):
    # Sessions move between releases: one of five photographs is gone on with there, and those made there open here.
    names = sorted(path.name for path in photographs.iterdir())
    brought, some = photographs.parent / "brought", photographs.parent / "some"
    some.mkdir()
    for name in names[:5]:
        shutil.copy(photographs / name, some)
    run(psfm, "run", some, "--session", brought, "--threads", "2")
    release.in_root(USE, [f"copy-in {release.package('psfm')} {photographs} {brought} /root"],
                    ["sync-out /root " + str(folder)])
    for session in ("session", "brought"):
        run(psfm, "check", "--session", folder / session)
        run(psfm, "run", photographs, "--session", folder / session, "--threads", "2")
        status = json.loads(subprocess.run([psfm, "status", "--session", folder / session, "--json"], check=True,
                                           capture_output=True, text=True).stdout)
        states = [image["state"] for image in status["image_list"]]
        assert states == ["placed"] * len(names), states
    for dataset in ("one_command", "train"):
        assert sorted(path.name for path in (folder / dataset / "0/images").iterdir()) == names
    assert (folder / "train/0/sparse/0/points3D.bin").stat().st_size > 10_000
    assert (folder / "train/0/images_2" / names[0]).exists()
    assert '"localised": true' in (folder / "localised.json").read_text()
    assert "--reduced" in (folder / "manual.txt").read_text().replace("\\-", "-")
    assert (folder / "completed.txt").read_text().split() == ["export"]
    user = (folder / "user.txt").read_text(encoding="utf-8")
    assert user.startswith("psfm:") and "#token=" in user, user


def main():
    build, release = Path(sys.argv[1]).resolve(), Release(sys.argv[2])
    if missing := release.what_is_missing():
        print(missing)
        return SKIPPED
    release.make()
    if release.name == running_release() and shutil.which("lintian"):
        run("lintian", "--fail-on", "error,warning", "--suppress-tags", "bogus-mail-host,bogus-mail-host-in-debian-changelog",
            release.package("psfm"),
            release.package("libpsfm-dev"))
    with tempfile.TemporaryDirectory() as name:
        folder = Path(name)
        run(build / "tests/synthetic/psfm-render-scene", folder / "scene", "--scene", "wall", "--images", "6", "--width",
            "640", "--height", "480", stdout=subprocess.DEVNULL)
        photographs = (folder / "scene/images").rename(folder / "photographs")
        (folder / "used").mkdir()
        use(release, build / "psfm", photographs, folder / "used")
        if "--dev" in sys.argv:
            release.in_root(LINK, [f"copy-in {release.package('libpsfm-dev')} {ROOT / 'tests/consumer'} /root"], [])
    print(f"{release.package('psfm').name}: installed, used and removed on a clean {release.name}")
    return 0


if __name__ == "__main__":
    if len(sys.argv) not in (3, 4) or sys.argv[2] not in RELEASES:
        print(__doc__)
        sys.exit(2)
    sys.exit(main())
