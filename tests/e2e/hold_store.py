"""Keeps a store's file locked for writing, as a disk that hangs would keep the daemon waiting, until its
standard input ends. Says "held" when it does, and writes nothing."""

import os
import sqlite3
import sys


def main():
    store = sqlite3.connect(os.path.join(sys.argv[1], "beltflow.db"), isolation_level=None)
    store.execute("BEGIN IMMEDIATE")
    print("held", flush=True)
    sys.stdin.read()
    store.execute("ROLLBACK")
    store.close()


if __name__ == "__main__":
    main()
