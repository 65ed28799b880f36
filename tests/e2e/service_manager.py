"""A service manager's socket for a story: prints each message that comes as a line of JSON, an object of
its fields. The first line is the socket's path. Ends with its standard input."""

import json
import os
import select
import socket
import sys
import tempfile


def main():
    with tempfile.TemporaryDirectory(prefix="beltflow-e2e-") as folder:
        path = os.path.join(folder, "notify")
        manager = socket.socket(socket.AF_UNIX, socket.SOCK_DGRAM)
        manager.bind(path)
        print(json.dumps(path), flush=True)
        while True:
            ready, _, _ = select.select([manager, sys.stdin], [], [])
            if sys.stdin in ready:
                break
            lines = manager.recv(65536).decode().split("\n")
            print(json.dumps(dict(line.split("=", 1) for line in lines)), flush=True)


if __name__ == "__main__":
    main()
