// SPDX-FileCopyrightText: 2026 the psfm authors
// SPDX-License-Identifier: BSD-3-Clause
//
// What `psfm export --format gltf` writes, judged by Khronos' validator.
// usage: node gltf_test.cjs BUILD [FILE.gltf ...]     (files: only these are judged)
// Exit code 77: gltf-validator is not there (tools/install-packages --ci fetches it).
'use strict';
const { execFileSync } = require('node:child_process');
const fs = require('node:fs');
const os = require('node:os');
const path = require('node:path');

function validator() {
    try {
        return require('gltf-validator');
    } catch {
        console.log('gltf-validator is not here: tools/install-packages --ci');
        process.exit(77);
    }
}

/** Targets of CMake whose program is not there. */
function not_built(build) {
    const programs = { psfm: 'psfm', psfm_render_scene: 'tests/synthetic/psfm-render-scene' };
    return Object.keys(programs).filter((target) => !fs.existsSync(path.join(build, programs[target])));
}

/** A session of a few photographs of a wall, and its glTF. */
function exported(build, folder) {
    const psfm = path.join(build, 'psfm');
    const quiet = { stdio: ['ignore', 'ignore', 'inherit'] };
    const session = path.join(folder, 'session');
    execFileSync(path.join(build, 'tests/synthetic/psfm-render-scene'),
        [path.join(folder, 'wall'), '--scene', 'wall', '--images', '6', '--width', '400', '--height', '300'], quiet);
    execFileSync(psfm, ['run', path.join(folder, 'wall/images'), '--session', session], quiet);
    const output = path.join(folder, 'gltf');
    execFileSync(psfm, ['export', '--session', session, '--format', 'gltf', '--output', output], quiet);
    return fs.readdirSync(output).filter((name) => name.endsWith('.gltf')).map((name) => path.join(output, name));
}

async function judge(file) {
    const report = await validator().validateBytes(new Uint8Array(fs.readFileSync(file)), {
        uri: path.basename(file),
        externalResourceFunction: async (uri) =>
            new Uint8Array(fs.readFileSync(path.join(path.dirname(file), decodeURIComponent(uri)))),
    });
    const { numErrors, numWarnings, numInfos, messages } = report.issues;
    console.log(`${file}: ${numErrors} errors, ${numWarnings} warnings, ${numInfos} infos; ` +
        `${report.info.totalVertexCount} vertices`);
    for (const message of messages) console.log(`  ${message.code} ${message.pointer ?? ''}: ${message.message}`);
    if (report.info.totalVertexCount < 100) throw new Error(`${file}: next to nothing is in it`);
    return numErrors + numWarnings === 0;
}

async function main() {
    const [build, ...given] = process.argv.slice(2);
    validator();
    const missing = given.length > 0 ? [] : not_built(path.resolve(build));
    if (missing.length > 0) {
        console.error(`not built: ${missing.join(', ')}; cmake --build ${build} --target ${missing.join(' ')}`);
        process.exitCode = 1;
        return;
    }
    const folder = fs.mkdtempSync(path.join(os.tmpdir(), 'psfm-gltf-'));
    try {
        const files = given.length > 0 ? given : exported(path.resolve(build), folder);
        if (files.length === 0) throw new Error('no glTF was written');
        let good = true;
        for (const file of files) good = (await judge(file)) && good;
        process.exitCode = good ? 0 : 1;
    } finally {
        fs.rmSync(folder, { recursive: true, force: true });
    }
}

main().catch((error) => {
    console.error(error);
    process.exitCode = 1;
});
