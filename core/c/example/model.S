/* The model file as it is, at a multiple of 4. */
    .section .rodata.model, "a"
    .balign 4
    .global model_file, model_file_end
model_file:
    .incbin MODEL_FILE
model_file_end:
#ifdef WHOLE_FILE
    .balign 4
    .global whole_file, whole_file_end
whole_file:
    .incbin WHOLE_FILE
whole_file_end:
#endif
#ifdef PLAN_FILE
    .balign 4
    .global plan_file, plan_file_end
plan_file:
    .incbin PLAN_FILE
plan_file_end:
#endif
#ifdef SETTINGS_FILE
    .balign 4
    .global settings_file, settings_file_end, machine_file, machine_file_end
machine_file:
    .incbin MACHINE_FILE
machine_file_end:
settings_file:
    .incbin SETTINGS_FILE
settings_file_end:
#endif
    .section .note.GNU-stack, "", %progbits
