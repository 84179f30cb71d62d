#!/usr/bin/env python3
"""A rigid process in Python, written from common/exchange/README.md alone: free bodies that neither turn nor touch.

Usage: foreign_rigid.py NAME. It polls instead of sleeping, and always wakes; see "Post and wake" there.
"""
import ctypes, math, mmap, os, platform, stat, struct, sys, time

ORDER, ANSWER, CONTACTS, RIGID_REPORTS, GATE, NEWS = 896, 1024, 1152, 1664, 2304, 2432
FLUID, RIGID, COORDINATOR = 512, 640, 768
FUTEX_WAKE, SYS_FUTEX = 1, {"x86_64": 202, "aarch64": 98}[platform.machine()]
libc = ctypes.CDLL(None, use_errno=True)


def fail(text):
    print(text, file=sys.stderr)
    sys.exit(5)


def start_time(pid):
    try:
        with open(f"/proc/{pid}/stat") as f:
            fields = f.read().rpartition(")")[2].split()
        return 0 if fields[0] in "ZX" else int(fields[19])
    except OSError:
        return 0


class Segment:
    def __init__(self, name):
        file = os.open("/dev/shm/" + name, os.O_RDWR | os.O_NOFOLLOW)
        info = os.fstat(file)
        if info.st_uid != os.geteuid() or stat.S_IMODE(info.st_mode) != 0o600:
            fail("not ours alone")
        self.m = mmap.mmap(file, info.st_size)
        magic, version, header, _, size = self.get("QIIQQ", 0)
        if (magic, version, header, size) != (0x3154534C4C41420A, 7, 4096, info.st_size):
            fail("another protocol")
        self.base = ctypes.addressof(ctypes.c_char.from_buffer(self.m))
        self.parts = [self.get("QQ", 128 + 16 * i) for i in range(17)]

    def get(self, form, at):
        return struct.unpack_from("<" + form, self.m, at)

    def put(self, form, at, *values):
        struct.pack_into("<" + form, self.m, at, *values)

    def word(self, at):  # one aligned load or store; Python cannot order them, x86 does
        return ctypes.c_uint32.from_address(self.base + at)

    def wake(self, at):
        libc.syscall(SYS_FUTEX, ctypes.c_void_p(self.base + at), FUTEX_WAKE, 2**31 - 1, None, None, 0)

    def beat(self):
        self.put("Q", RIGID + 16, self.get("Q", RIGID + 16)[0] + 1)

    def check_others(self):
        for name, line in (("fluid process", FLUID), ("coordinator", COORDINATOR)):
            pid, state, start = self.get("IIQ", line)
            if pid and state != 2 and start_time(pid) != start:
                fail(f"the {name} (pid {pid}) died")

    def await_order(self, received):
        """True: an order has come. False: the run has ended."""
        looked = time.monotonic()
        while self.word(ORDER).value == received:
            time.sleep(1e-4)
            if time.monotonic() - looked > 0.05:
                looked = time.monotonic()
                self.beat()
                if self.get("I", FLUID + 4)[0] == 2 and self.word(ORDER).value == received:
                    return False
                self.check_others()
        return True


def state_hash(states):
    value = 0xCBF29CE484222325
    for s in states:
        for byte in struct.pack("<13d", *s[:13]):
            value = (value ^ byte) * 0x100000001B3 & 0xFFFFFFFFFFFFFFFF
    return value


def main(name):
    seg = Segment(name)
    gravity = seg.get("3d", seg.parts[0][0])
    bodies = []
    for at in range(seg.parts[1][0], seg.parts[1][0] + seg.parts[1][1], 368):
        mass, = seg.get("d", at + 64)
        bodies.append((mass, list(seg.get("13d", at + 120))))
    n = len(bodies)
    if seg.get("Q", 80)[0] or seg.get("d", 88)[0]:
        fail("this process can neither write checkpoints nor go on from one")
    if seg.get("I", RIGID)[0]:
        fail("the role is taken")
    seg.put("I", RIGID, os.getpid())
    seg.put("Q", RIGID + 8, start_time(os.getpid()))
    seg.word(RIGID + 4).value = 1

    def post(sequence, step, iteration, t):
        states = [x + [0.0] * 3 + [0.0] * 3 + list(gravity) + [0.0] * 3 +
                  [1 / mass if i == j and i < 3 else 0.0 for i in range(6) for j in range(6)] for mass, x in bodies]
        at = seg.parts[9][0]
        seg.put("QIIddQII", at, step, iteration, n, t, float("inf"), state_hash(states), 0, 0)
        for b, s in enumerate(states):
            seg.put("61d", at + 48 + 488 * b, *s)
        seg.beat()
        seg.word(ANSWER).value = sequence
        seg.wake(ANSWER)
        return state_hash(states)

    impulse = [0.0] * 4  # x y z and the sum of magnitudes, of steps that are kept

    def report(step, iteration, t, dt, digest, forces):
        for force in forces:
            for k, part in enumerate((*force, math.hypot(*force))):
                impulse[k] += dt * part
        start, size = seg.parts[12]
        head = seg.word(RIGID_REPORTS).value
        while (head + 24 + 144 - seg.word(RIGID_REPORTS + 128).value) % 2**32 > size:
            time.sleep(1e-3)
        frame = struct.pack("<IIQd", 0, 144, step, t)
        frame += struct.pack("<QIIddddQ4dQ6d", step, iteration, 0, t, dt, 0, 0, digest, 0, 0, 0, 0, 0, 0, 0, *impulse)
        for i, byte in enumerate(frame):
            seg.m[start + (head + i) % size] = byte
        seg.word(RIGID_REPORTS).value = (head + len(frame)) % 2**32
        ctypes.c_uint32.from_address(seg.base + NEWS).value += 1  # not atomic: a wake-up may come 50 ms late
        seg.wake(NEWS)

    post(1, 0, 0, 0.0)
    received, saved, pending = 0, None, None
    while seg.await_order(received):
        received += 1
        if seg.word(ORDER).value != received:
            fail("sequence")
        at = seg.parts[8][0]
        step, iteration, flags, t, dt, _, count, contacts, _, commands, _ = seg.get("QIIdddIIQII", at)
        if count != n:
            fail("bodies")
        if commands:
            fail("this process obeys no commands")
        if flags & 2:
            bodies = [(m, list(x)) for m, x in saved]
        elif pending:
            report(*pending)
        saved = [(m, list(x)) for m, x in bodies]
        tail = seg.word(CONTACTS + 128)
        tail.value = (tail.value + 96 * contacts) % 2**32
        forces = [seg.get("3d", at + 64 + 48 * b) for b in range(n)]
        for (mass, x), force in zip(bodies if not flags & 8 else [], forces):
            for k in range(3):
                x[7 + k] += dt * (gravity[k] + force[k] / mass)
                x[k] += dt * x[7 + k]
        seg.put("Q", RIGID + 24, step)
        pending = (step, iteration, t + dt, dt, post(received + 1, step, iteration, t + dt), forces)
    if pending:
        report(*pending)
    text = b'{"engine": "foreign_rigid.py"}'
    start, _ = seg.parts[14]
    seg.m[start:start + len(text)] = text
    seg.put("Q", RIGID + 40, len(text))
    seg.put("i", RIGID + 32, 0)
    seg.word(RIGID + 4).value = 2
    ctypes.c_uint32.from_address(seg.base + NEWS).value += 1
    seg.wake(NEWS)


if __name__ == "__main__":
    main(sys.argv[1])
