"""python -m mcgee"""

from mcgee.cli import main

main()
