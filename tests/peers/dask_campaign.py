"""A campaign on a Dask cluster of four workers of this machine, one of which is killed in the middle, and in one process.

    dask_campaign.py PROGRAM SCENARIO

Prints a JSON object: whether both tables are the same to the byte, and how many workers were killed and came back.
"""
import json
import os
import signal
import sys

from distributed import Client, LocalCluster

import onescan_client


def main(program: str, scenario: str) -> None:
    alone = onescan_client.campaign(scenario, program=program)
    with LocalCluster(n_workers=4, threads_per_worker=1, dashboard_address=None) as cluster, Client(cluster) as client:
        workers = dict(client.run(os.getpid))
        killed = []

        def kill_one(done: int, of: int) -> None:
            # In the middle: some parts are done, and some of those that are left are being done by whoever is killed.
            if done < of // 4 or killed:
                return
            busy = [address for address, tasks in client.processing().items() if tasks and address in workers]
            if busy:
                os.kill(workers[busy[0]], signal.SIGKILL)
                killed.append(busy[0])

        spread = onescan_client.campaign(scenario, client=client, program=program, parts=16, on_part=kill_one)
        lost = [address for address in killed if address not in client.scheduler_info(n_workers=-1)["workers"]]
    same = spread.text == alone.text and spread.passed == alone.passed
    print(json.dumps({"same": same, "runs": len(spread.runs), "killed": len(killed), "lost": len(lost)}))


if __name__ == "__main__":
    main(*sys.argv[1:])
