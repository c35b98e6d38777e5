#!/bin/sh
# What became of a job of Slurm: running, success or failed.
# A job that the controller cannot be asked about just now goes on; one that it has forgotten did not succeed.
answer=$(scontrol --oneliner show job "$1" 2>&1) || case $answer in
    *"Invalid job id"*) echo failed; exit ;;
    *) echo running; exit ;;
esac
case $answer in
    *JobState=COMPLETED*) echo success ;;
    *JobState=PENDING* | *JobState=CONFIGURING* | *JobState=RUNNING* | *JobState=COMPLETING* | *JobState=SUSPENDED* | \
        *JobState=REQUEUED* | *JobState=STAGE_OUT*) echo running ;;
    *) echo failed ;;
esac
