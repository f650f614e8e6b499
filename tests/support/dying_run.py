"""A study whose run 5 ends its process. Processes that do its runs import little."""

import os

from jointfmu_tools.studies.uncertainty.worker import FmuRamp


class DiesAtFive(FmuRamp):
    """Four runs make a job, so that three others are lost with run 5."""

    runs_per_job = 4

    def run(self, index, settings):
        if index == 5:
            os._exit(11)
        columns = {"tau": [0.0, 1.0], "K_WTS": [1.0, 1.0]}
        return {"run": index, "parameters": dict(settings), "columns": columns}
