// Studies as jobs of Nextflow: each is one process, because hifdm sweep itself keeps all cores busy until its last point
// is done, and goes on where it was stopped.
//
//     nextflow run tools/packages/sweep.nf --studies 'configs/pretension-sweep.yaml' --also 'configs/chen2022.yaml'
//
// --studies, --also: files or patterns; `also` are base cases and the tables that they name, which stand beside the
// study. --results FOLDER (results) gets STUDY.d, which outlives the work folder of a process, STUDY.h5 and STUDY.html.
// A failed point fails no process: the table says why it failed.
//
// NOT TRIED: Nextflow is not in Debian 12. What it runs is what tools/packages/Snakefile runs, which is tried.
nextflow.enable.dsl = 2

params.studies = null
params.also = []
params.results = 'results'
params.program = 'hifdm'
params.cpus = Runtime.runtime.availableProcessors()

process sweep {
    cpus params.cpus
    cache false // hifdm knows itself which points are done

    input:
    path study
    path also
    val folder

    output:
    path "${study.baseName}.html"

    script:
    """
    mkdir -p '${folder}'
    code=0
    ${params.program} sweep '${study}' --dir '${folder}/${study.baseName}.d' --threads ${task.cpus} \\
        --retry missing,outdated --quiet || code=\$?
    [ \$code = 0 ] || [ \$code = 3 ] || exit \$code
    ${params.program} merge '${study}' --dir '${folder}/${study.baseName}.d' -o '${folder}/${study.baseName}.h5' \\
        --force --quiet
    ${params.program} report '${folder}/${study.baseName}.h5' -o '${study.baseName}.html' --force >/dev/null
    cp '${study.baseName}.html' '${folder}/'
    """
}

workflow {
    if (!params.studies) error 'which studies? --studies FILE'
    also = Channel.fromPath(params.also, checkIfExists: true).collect().ifEmpty([])
    studies = Channel.fromPath(params.studies, checkIfExists: true).toList().flatMap { all ->
        twice = all.countBy { it.baseName }.findAll { it.value > 1 }.keySet()
        if (twice) error "several studies would write the same files: ${twice.join(', ')}; rename them"
        all
    }
    sweep(studies, also, file(params.results).toAbsolutePath().toString())
}
