"""A copy of this machine that may be changed: the root file system under an overlay in memory, a network of its own
without any way out, no devices, and stand-ins for what only an init system can do."""
import os
import subprocess
from pathlib import Path

# They write down how they were called, and do nothing.
STAND_INS = ("systemctl", "journalctl", "sysctl", "udevadm")
CALLS = "/tmp/calls"
DEVICES = ("null", "zero", "full", "random", "urandom", "tty")


def shell(command):
    subprocess.run(["sh", "-euc", command], check=True)


def enter(tree, memory="4g"):
    """In namespaces of its own (unshare --mount --net --pid --fork) already. The process comes out of it chrooted, in `tree`."""
    work = "/mnt"
    shell(f"mount --make-rprivate / && mount -t tmpfs -o size={memory} none {work} && cd {work} && mkdir upper work root "
          f"&& mount -t overlay -o lowerdir=/,upperdir={work}/upper,workdir={work}/work none root")
    root = f"{work}/root"
    if subprocess.run(["stat", "-c", "%d", "/"], capture_output=True).stdout != \
            subprocess.run(["stat", "-c", "%d", tree], capture_output=True).stdout:
        shell(f"cd {work} && mkdir upper_tree work_tree && mount -t overlay "
              f"-o lowerdir={tree},upperdir={work}/upper_tree,workdir={work}/work_tree none {root}{tree}")
    shell(f"cd {root} && mount -t proc none proc && mount -t sysfs none sys && mount -t tmpfs none tmp && chmod 1777 tmp "
          "&& mount -t tmpfs none run && mkdir run/lock && mount -t tmpfs none dev && mkdir dev/pts dev/shm "
          "&& mount -t devpts -o newinstance,ptmxmode=666 none dev/pts && ln -s pts/ptmx dev/ptmx && ln -s /proc/self/fd dev/fd")
    for device in DEVICES:
        shell(f"touch {root}/dev/{device} && mount --bind /dev/{device} {root}/dev/{device}")
    shell("ip link set lo up")
    os.chroot(root)
    os.chdir(tree)
    for name in STAND_INS:
        stand_in = Path("/usr/local/sbin") / name
        stand_in.write_text(f'#!/bin/sh\necho "{name} $*" >>{CALLS}\n')
        stand_in.chmod(0o755)
    os.environ["PATH"] = "/usr/local/sbin:/usr/local/bin:/usr/sbin:/usr/bin:/sbin:/bin"


def calls():
    return Path(CALLS).read_text() if Path(CALLS).exists() else ""
