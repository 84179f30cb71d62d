#!/usr/bin/env python3
"""A tcpq server that greets like LCM's and then never reads: the worst of all monitors. Prints its port."""
import socket
import struct
import time

listener = socket.socket()
listener.setsockopt(socket.SOL_SOCKET, socket.SO_RCVBUF, 4096)
listener.bind(("127.0.0.1", 0))
listener.listen()
print(listener.getsockname()[1], flush=True)
client, _ = listener.accept()
client.sendall(struct.pack(">II", 0x287617FA, 0x0100))  # server's greeting, protocol version
time.sleep(600)
